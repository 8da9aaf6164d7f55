/* APART: of a function that is called, never inlined, so that its code stands once and its locals are on the stack while it
 * runs alone. SELDOM: of one besides whose time hardly counts, so that its code is to be small, where a compiler takes this
 * for one function. */
#ifndef DRAWBAR_APART_H
#define DRAWBAR_APART_H

#if defined(__GNUC__)
#define APART __attribute__((noinline))
#else
#define APART
#endif
#if defined(__clang__)
#define SELDOM APART __attribute__((minsize))
#else
#define SELDOM APART
#endif

#endif
