/* Packs: rows of NX numbers as whole SIMD registers.
 *
 * A matrix row is padded with zeros to WIDTH numbers, PACKS registers of PACK numbers each. Where registers hold four
 * numbers, GNU vectors keep sums of rows in them; elsewhere the same loops over plain numbers are faster.
 */
#ifndef DRAWBAR_PACKS_H
#define DRAWBAR_PACKS_H

#ifndef PACK
#if defined(__AVX__) && defined(__GNUC__) && NX > 4
#define PACK 4
#else
#define PACK 1
#endif
#endif
#if PACK > 1
#if !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"   /* packs are passed between inlined functions only */
#endif
typedef double pack __attribute__((vector_size(8 * PACK)));
typedef double pack_in_memory __attribute__((vector_size(8 * PACK), aligned(8), may_alias));
#define LANE_OF(value, l) ((value)[l])
#else
typedef double pack, pack_in_memory;
#define LANE_OF(value, l) (value)
#endif

/* gcc 12 may take a large struct on the stack for aligned to whole registers without seeing to it: say so. */
#if defined(__GNUC__)
#define ON_STACK __attribute__((aligned(64)))
#else
#define ON_STACK
#endif

#define PACKS ((NX + PACK - 1) / PACK)
#define WIDTH (PACKS * PACK)
#define TAIL (NX % PACK)                   /* numbers in the last register when it is not full */
#if defined(__GNUC__) && !defined(__clang__) && NX <= 4
#define UNROLLED _Pragma("GCC unroll 4")   /* small matrices live in registers */
#else
#define UNROLLED
#endif
#define EACH_PACK(b) UNROLLED for (int b = 0; b < PACKS; ++b)
/* Loops whose turns each know the number of their pack, so that what they work on stays in registers. */
#if PACK > 1 && defined(__clang__)
#define EACH_KNOWN _Pragma("clang loop unroll(full)")
#elif PACK > 1
#define EACH_KNOWN _Pragma("GCC unroll 8")
#else
#define EACH_KNOWN UNROLLED
#endif
#define PACK_END(c) ((c) < NX / PACK ? ((c) + 1) * PACK : NX)

static inline pack read_pack(const double *row, int b)
{
    return *(const pack_in_memory *)(row + b * PACK);
}

/* A macro, since gcc 12 notes a change of its ABI, and cannot be kept from it, where a pack is a parameter. */
#define write_pack(row, b, value) (*(pack_in_memory *)((row) + (b) * PACK) = (value))

/* A vector of NX numbers, not padded in memory. */
static inline void read_vector(pack *restrict to, const double *restrict from)
{
    for (int b = 0; b < NX / PACK; ++b)
        to[b] = read_pack(from, b);
#if TAIL
    const double *rest = from + NX - TAIL;
    to[PACKS - 1] = (pack){rest[0], TAIL > 1 ? rest[TAIL > 1] : 0.0, TAIL > 2 ? rest[TAIL > 2 ? 2 : 0] : 0.0};
#endif
}

static inline void write_vector(double *restrict to, const pack *restrict from)
{
    for (int b = 0; b < NX / PACK; ++b)
        write_pack(to, b, from[b]);
#if TAIL
    for (int l = 0; l < TAIL; ++l)
        to[NX - TAIL + l] = from[PACKS - 1][l];
#endif
}

static inline void read_row(pack *restrict to, const double *restrict row)
{
    EACH_PACK(b)
        to[b] = read_pack(row, b);
}

static inline void write_row(double *restrict row, const pack *restrict from)
{
    EACH_PACK(b)
        write_pack(row, b, from[b]);
}

/* sum += factor * row */
static inline void add_row(pack *restrict sum, double factor, const double *restrict row)
{
    EACH_PACK(b)
        sum[b] += factor * read_pack(row, b);
}

/* Rows i of a symmetric matrix, each from pack c, which holds its diagonal, on: mirror() makes the rest. Loops over plain
 * numbers that are not unrolled take whole rows, since many lengths would keep a compiler from SIMD code. */
#if PACK == 1 && !(defined(__GNUC__) && !defined(__clang__) && NX <= 4)
#define EACH_UPPER_ROW(c, i) for (int i = 0, c = 0; i < NX; ++i)
#else
#define EACH_UPPER_ROW(c, i) \
    EACH_KNOWN for (int c = 0; c < PACKS; ++c) \
        UNROLLED for (int i = c * PACK; i < PACK_END(c); ++i)
#endif

static inline void read_row_from(int c, pack *restrict to, const double *restrict row)
{
    UNROLLED for (int b = c; b < PACKS; ++b)
        to[b] = read_pack(row, b);
}

static inline void write_row_from(int c, double *restrict row, const pack *restrict from)
{
    UNROLLED for (int b = c; b < PACKS; ++b)
        write_pack(row, b, from[b]);
}

static inline void add_row_from(int c, pack *restrict sum, double factor, const double *restrict row)
{
    UNROLLED for (int b = c; b < PACKS; ++b)
        sum[b] += factor * read_pack(row, b);
}

/* The lower half of a symmetric matrix from its upper one, by whole packs: what is stored number by number cannot be read
 * in one soon after. */
static inline void mirror(double (*restrict M)[WIDTH])
{
#if PACK == 1
    UNROLLED for (int i = 1; i < NX; ++i)
        UNROLLED for (int j = 0; j < i; ++j)
            M[i][j] = M[j][i];
#else
    EACH_KNOWN for (int c = 0; c < PACKS; ++c) {
        const int d = c * PACK;
        for (int i = d; i < PACK_END(c); ++i)
            for (int b = 0; b < c; ++b)
                write_pack(M[i], b, ((pack){M[b * PACK][i], M[b * PACK + 1][i], M[b * PACK + 2][i], M[b * PACK + 3][i]}));
        for (int i = d + 1; i < PACK_END(c); ++i) {
            pack row = read_pack(M[i], c);
            for (int j = d; j < i; ++j)
                row[j - d] = M[j][i];
            write_pack(M[i], c, row);
        }
    }
#endif
}

/* 1 for states from the given one on, 0 for those before. */
static inline pack mask_from(int state, int b)
{
#if PACK > 1
    const int first = b * PACK;
    return (pack){first >= state, first + 1 >= state, first + 2 >= state, first + 3 >= state};
#else
    return b >= state;
#endif
}

/* start + row' vector */
static inline double add_dot(double start, const double *restrict row, const pack *restrict vector)
{
#if PACK == 1
    double sum = start;
    EACH_PACK(b)
        sum += row[b] * vector[b];
    return sum;
#else
    pack sum = read_pack(row, 0) * vector[0];
    for (int b = 1; b < PACKS; ++b)
        sum += read_pack(row, b) * vector[b];
    return start + ((sum[0] + sum[2]) + (sum[1] + sum[3]));
#endif
}

#endif
