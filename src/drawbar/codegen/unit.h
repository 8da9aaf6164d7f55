/* Unit: UNIT(name) names what a unit offers to the others of its library; the unit defines it before it includes
 * anything.
 *
 * In Python's own library a solver can have a watcher, which is called before each of its phases, with the data in place; an
 * exported library has none.
 */
#ifndef DRAWBAR_UNIT_H
#define DRAWBAR_UNIT_H

#ifdef DRAWBAR_HOSTED
#include <stdint.h>

enum solver_phase { WATCHED_PREPARE, WATCHED_FEEDBACK, WATCHED_SHIFT, WATCHED_SLIDE };

static void (*watcher)(int32_t phase);
#define WATCHED(phase, call) (watcher ? watcher(phase) : (void)0, (void)(call))
#else
#define WATCHED(phase, call) (void)(call)
#endif

#endif
