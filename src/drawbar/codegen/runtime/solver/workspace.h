/* Memory of a unit that stands alone: the part, and behind it what the part borrows for the length of a call (WORK, where
 * it needs any). In an exported library all parts borrow the same.
 */
#ifndef DRAWBAR_WORKSPACE_H
#define DRAWBAR_WORKSPACE_H

#include "fields.h"

struct workspace {
    struct part part;
#ifdef WORK
    WORK work;
#endif
};

int64_t drawbar_size = sizeof(struct workspace), drawbar_part_size = sizeof(struct part);

#endif
