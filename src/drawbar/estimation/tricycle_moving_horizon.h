/* Moving horizon estimation on the tricycle model. */
#include "tricycle_estimation.h"
#include "moving_horizon.h"
