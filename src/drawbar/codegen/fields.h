/* Fields of the workspace: names, places and shapes for a caller in another language. */
#ifndef DRAWBAR_FIELDS_H
#define DRAWBAR_FIELDS_H

#include <stddef.h>
#include <stdint.h>

struct drawbar_field {
    const char *name;
    int64_t offset;
    int32_t kind;                          /* 0: double, 1: int32 */
    int32_t shape[3];                      /* as stored; trailing zeros are dropped, EMPTY is a dimension of none */
    int32_t padding;                       /* numbers at the end of each row that only fill it up */
    int32_t setting;                       /* set once, before the first call */
};

#define EMPTY (-1)
#define FIELD(type, name, kind, a, b, c) {#name, (int64_t)offsetof(struct type, name), kind, {a, b, c}, 0, 0},
#define SETTING(type, name, kind, a, b, c) {#name, (int64_t)offsetof(struct type, name), kind, {a, b, c}, 0, 1},
#define ROWS(type, name, a, b) {#name, (int64_t)offsetof(struct type, name), 0, {a, b, WIDTH}, WIDTH - NX, 0},
#define END_OF_FIELDS {NULL, 0, 0, {0, 0, 0}, 0, 0}

#define RTI(name, kind, a, b, c) FIELD(component, rti.name, kind, a, b, c)
#define SET(name, a, b) SETTING(component, rti.name, 0, a, b, 0)
#define QP_FIELDS(type, prefix)                                                                              \
    ROWS(type, prefix Q, N + 1, NX) ROWS(type, prefix S, CROSS ? N : EMPTY, NU) ROWS(type, prefix A, N, ND)                  \
    FIELD(type, prefix R, 0, N, NU, NU) FIELD(type, prefix B, 0, N, ND, NU) FIELD(type, prefix c, 0, N, NX, 0) \
    FIELD(type, prefix g, 0, NZ, 0, 0) FIELD(type, prefix initial, 0, NX, 0, 0)                              \
    FIELD(type, prefix lower, 0, NB, 0, 0) FIELD(type, prefix upper, 0, NB, 0, 0)                            \
    SETTING(type, prefix soft_linear, 0, NB, 0, 0) SETTING(type, prefix soft_quadratic, 0, NB, 0, 0)         \
    SETTING(type, prefix bound, 1, NB, 0, 0) FIELD(type, prefix z, 0, NZ, 0, 0)                                \
    FIELD(type, prefix pi, 0, N + 1, NX, 0) FIELD(type, prefix multiplier, 0, NSIDES, 0, 0)                  \
    FIELD(type, prefix violation, 0, NSIDES, 0, 0) FIELD(type, prefix kkt, 0, 1, 0, 0)                       \
    FIELD(type, prefix status, 1, 1, 0, 0) FIELD(type, prefix iterations, 1, 1, 0, 0)                        \
    FIELD(type, prefix factored, 1, 1, 0, 0) FIELD(type, prefix kept, 1, N, NU, 0)                           \
    ROWS(type, prefix P, N + 1, NX)                                                                          \
    ROWS(type, prefix K, N, NU)

#endif
