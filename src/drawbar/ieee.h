/* IEEE arithmetic: NaN, infinity, the order of sums as it is written, and every number as wide as its type. Without NaN
 * nothing is checked any more; sines round by adding a large number. */
#ifndef DRAWBAR_IEEE_H
#define DRAWBAR_IEEE_H

#include <float.h>
#include <math.h>

#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(_M_FP_FAST) \
    || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "drawbar needs IEEE arithmetic: compile it without -ffast-math, -Ofast, /fp:fast and their kind"
#endif
#if (FLT_EVAL_METHOD != 0 && FLT_EVAL_METHOD != 16) /* 16: half precision, of which no source knows */ \
    || (defined(__i386__) && !defined(__SSE2_MATH__))    /* clang, for a processor with SSE alone: 0 is of floats */
#error "drawbar needs numbers as wide as their type: compile it for 32-bit x86 with -msse2 -mfpmath=sse"
#endif
#if defined(__clang__) && __clang_major__ >= 13    /* it does not say when -funsafe-math-optimizations is on */
#pragma clang fp reassociate(off)
#endif

/* where this fails: compile without -fsingle-precision-constant */
typedef char constants_are_doubles[sizeof(1.0) == sizeof(double) ? 1 : -1];

/* Whether a missing value is no number here: what a compiler that tells nothing by a macro does is tried out. */
static inline int ieee_knows_missing(void)
{
    const volatile double given = (double)NAN;                         /* volatile: it must not know it */
    const double missing = given;

    return missing != missing && !(fabs(missing) <= 1.0);
}

#endif
