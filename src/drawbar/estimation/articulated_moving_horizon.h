/* Moving horizon estimation on the articulated model. */
#include "articulated_estimation.h"
#include "moving_horizon.h"
