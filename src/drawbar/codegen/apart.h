/* APART: of a function that is called, never inlined, so that its code stands once and its locals are on the stack while it
 * runs alone. */
#ifndef DRAWBAR_APART_H
#define DRAWBAR_APART_H

#if defined(__GNUC__)
#define APART __attribute__((noinline))
#else
#define APART
#endif

#endif
