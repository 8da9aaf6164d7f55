/* Memory of a unit that stands alone: the component, and behind it what it borrows for the length of a call (WORK, where
 * it needs any). In an exported library all components borrow the same.
 */
#ifndef DRAWBAR_WORKSPACE_H
#define DRAWBAR_WORKSPACE_H

#include "fields.h"

struct workspace {
    struct component component;
#ifdef WORK
    WORK work;
#endif
};

int64_t drawbar_size = sizeof(struct workspace);

#endif
