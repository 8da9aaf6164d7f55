/* How a unit names what it offers: as it is where it stands alone, `drawbar_<unit>_<name>` inside an exported library,
 * whose units define UNIT before they include anything. */
#ifndef DRAWBAR_UNIT_H
#define DRAWBAR_UNIT_H

#ifndef UNIT
#define UNIT(name) name
#endif

#endif
