/* Lane loops: how a loop over stages is declared so that it becomes SIMD code. */
#ifndef DRAWBAR_LANE_LOOPS_H
#define DRAWBAR_LANE_LOOPS_H

#ifndef LANES
#define LANES 8                            /* stages at once; a unit with one stage says 1 */
#endif

#if defined(__GNUC__)
#define LANE static inline __attribute__((always_inline))   /* a call inside the loop would undo its SIMD code */
#else
#define LANE static inline
#endif

#if defined(__GNUC__) && !defined(__clang__)
#define EACH_LANE _Pragma("GCC unroll 8") for
#else
#define EACH_LANE for
#endif

#endif
