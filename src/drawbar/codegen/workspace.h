/* Workspace of a unit that stands alone: the component, and behind it its scratch memory (WORK, where it needs any). In an
 * exported library all components share that.
 */
#ifndef DRAWBAR_WORKSPACE_H
#define DRAWBAR_WORKSPACE_H

#include "fields.h"

/* Where rows of the work do not begin on SIMD registers' places, a feedback takes up to 6 % longer. */
#if defined(__GNUC__)
#define ALIGNED __attribute__((aligned(64)))
#else
#define ALIGNED
#endif

struct workspace {
    struct component component;
#ifdef WORK
    WORK work ALIGNED;
#endif
};

int64_t drawbar_size = sizeof(struct workspace);

#endif
