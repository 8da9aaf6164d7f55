/* How a unit names what it offers: as it is where it stands alone, `drawbar_<unit>_<name>` inside an exported library,
 * whose units define UNIT before they include anything.
 *
 * A unit with a solver that stands alone leaves the solver's phases to its caller, who may want to time or to watch
 * them; an exported one offers what comes before, between and after them in one call.
 */
#ifndef DRAWBAR_UNIT_H
#define DRAWBAR_UNIT_H

#ifdef UNIT
#define EXPORTED
#else
#define UNIT(name) name
#endif

#endif
