/* Quads: sums and largest sizes of long sequences of numbers, four at a time in SIMD registers, where a processor has them. */
#ifndef DRAWBAR_QUADS_H
#define DRAWBAR_QUADS_H

#include <math.h>
#include <stdint.h>

#define QUAD 4
#if QUAD > 1 && defined(__GNUC__) && (defined(__SSE2__) || defined(__aarch64__))
#define QUADS
typedef double quad __attribute__((vector_size(8 * QUAD)));
typedef int64_t quad_bits __attribute__((vector_size(8 * QUAD)));
typedef double quad_in_memory __attribute__((vector_size(8 * QUAD), aligned(8), may_alias));
#define MOST_QUADS ((NX + NU) / QUAD + QUAD)
#define QUAD_PLACE(b, width) ((b) * QUAD + QUAD <= (width) ? (b) * QUAD : (width) - QUAD)
#define quad_size(value) ((quad)((quad_bits)(value) & INT64_MAX))
#define read_quad(values) (*(const quad_in_memory *)(values))
#if defined(__clang__)
#define ROLLED _Pragma("clang loop unroll(disable)")   /* all stages one behind the other are 10 KiB of code */
#else
#define ROLLED _Pragma("GCC unroll 1")
#endif
#endif

static inline double largest(double bound, double value)
{
    const double size = fabs(value);
    return size > bound ? size : bound;    /* a NaN is caught by all_finite */
}

/* The largest size of each of so many kinds of numbers, which follow each other stage by stage, and of `most` (kinds). Registers
 * that are not full, and stages that are not enough for them, are filled with numbers that are looked at twice. */
static inline void largest_of_kinds(const double *restrict values, int stages, int kinds, double *restrict most)
{
#if defined(QUADS)
    const int together = kinds < QUAD ? QUAD : 1, width = together * kinds;
    if (stages >= together) {
        quad side[MOST_QUADS];
        for (int b = 0; b * QUAD < width; ++b)
            side[b] = (quad){0.0};
        for (int b = 0; b * QUAD < width && together == 1; ++b)
            side[b] = read_quad(most + QUAD_PLACE(b, width));
        ROLLED for (int k = 0; k < stages; k += together) {
            const double *at = values + (k + together <= stages ? k : stages - together) * kinds;
            for (int b = 0; b * QUAD < width; ++b) {
                const quad size = quad_size(read_quad(at + QUAD_PLACE(b, width)));
                const quad_bits above = size > side[b];
                side[b] = (quad)((above & (quad_bits)size) | (~above & (quad_bits)side[b]));
            }
        }
        for (int b = 0; b * QUAD < width; ++b)
            if (together > 1)
                for (int l = 0; l < QUAD; ++l) {
                    double *own = &most[(b * QUAD + l) % kinds];
                    *own = largest(*own, side[b][l]);
                }
            else
                *(quad_in_memory *)(most + QUAD_PLACE(b, width)) = side[b];
        return;
    }
#endif
    for (int i = 0; i < stages * kinds; ++i)
        most[i % kinds] = largest(most[i % kinds], values[i]);
}

/* Adds the products of two sequences of numbers to `sum`, and their sizes to `sizes`. */
static inline void add_products(const double *restrict a, const double *restrict b, int count, double *restrict sum,
                                double *restrict sizes)
{
    int i = 0;

#if defined(QUADS)
    quad sums = {0.0}, of_sizes = {0.0};
    ROLLED for (; i + QUAD <= count; i += QUAD) {
        const quad product = read_quad(a + i) * read_quad(b + i);
        sums += product;
        of_sizes += quad_size(product);
    }
    for (int l = 0; l < QUAD; ++l) {
        *sum += sums[l];
        *sizes += of_sizes[l];
    }
#endif
    for (; i < count; ++i) {
        *sum += a[i] * b[i];
        *sizes += fabs(a[i] * b[i]);
    }
}

#endif
