/* IEEE arithmetic: NaN, infinity and the order of sums as it is written. Without them nothing is checked any more. */
#ifndef DRAWBAR_IEEE_H
#define DRAWBAR_IEEE_H

#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(_M_FP_FAST) \
    || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "drawbar needs IEEE arithmetic: compile it without -ffast-math, -Ofast, /fp:fast and their kind"
#endif
#if defined(__clang__) && __clang_major__ >= 13    /* it does not say when -funsafe-math-optimizations is on */
#pragma clang fp reassociate(off)
#endif

#endif
