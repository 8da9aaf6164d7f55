/* NOINLINE: of a function whose code is to stand once, and whose locals are on the stack only while it runs.
 * COLD: the same of a function whose time hardly counts, so that its code is to be small, where a compiler can. */
#ifndef DRAWBAR_NOINLINE_H
#define DRAWBAR_NOINLINE_H

#if defined(__GNUC__)
#define NOINLINE __attribute__((noinline))
#else
#define NOINLINE
#endif
#if defined(__clang__)
#define COLD NOINLINE __attribute__((minsize))
#else
#define COLD NOINLINE
#endif

#endif
