/* Tells a caller in another language where the fields of the workspace are. */
#ifndef DRAWBAR_FIELDS_H
#define DRAWBAR_FIELDS_H

#include <stddef.h>
#include <stdint.h>

struct drawbar_field {
    const char *name;
    int64_t offset;
    int32_t kind;                          /* 0: double, 1: int32 */
    int32_t shape[3];                      /* trailing ones are dropped */
};

#define FIELD(type, name, kind, a, b, c) {#name, (int64_t)offsetof(struct type, name), kind, {a, b, c}},

#define QP_FIELDS(type, prefix)                                                                              \
    FIELD(type, prefix Q, 0, N + 1, NX, NX) FIELD(type, prefix S, 0, N, NU, NX) FIELD(type, prefix R, 0, N, NU, NU) \
    FIELD(type, prefix A, 0, N, NX, NX) FIELD(type, prefix B, 0, N, NX, NU) FIELD(type, prefix c, 0, N, NX, 0) \
    FIELD(type, prefix g, 0, NZ, 0, 0) FIELD(type, prefix initial, 0, NX, 0, 0)                              \
    FIELD(type, prefix lower, 0, NB, 0, 0) FIELD(type, prefix upper, 0, NB, 0, 0)                            \
    FIELD(type, prefix soft_linear, 0, NB, 0, 0) FIELD(type, prefix soft_quadratic, 0, NB, 0, 0)             \
    FIELD(type, prefix bound, 1, NB, 0, 0) FIELD(type, prefix z, 0, NZ, 0, 0)                                \
    FIELD(type, prefix pi, 0, N + 1, NX, 0) FIELD(type, prefix multiplier, 0, NSIDES, 0, 0)                  \
    FIELD(type, prefix violation, 0, NSIDES, 0, 0) FIELD(type, prefix kkt, 0, 1, 0, 0)                       \
    FIELD(type, prefix status, 1, 1, 0, 0) FIELD(type, prefix iterations, 1, 1, 0, 0)                        \
    FIELD(type, prefix factored, 1, 1, 0, 0) FIELD(type, prefix P, 0, N + 1, NX, NX)                         \
    FIELD(type, prefix K, 0, N, NU, NX)

#endif
