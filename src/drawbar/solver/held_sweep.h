/* Held sweep: Riccati recursion in which held inputs have no choice left.
 *
 * A bound that is held at stage k says what one input of that stage does: that of an input by itself, u_a = bound; that of
 * a state which this input alone moves, x_{k+1,j} = bound, by u_a = (bound - c_j - A_j x) / B_ja. The recursion goes on with
 * this law in the place of the optimal one, and its multiplier is what is left of the input's gradient. Bounds that have
 * given way are held by nothing: their price pulls.
 */
#ifndef DRAWBAR_HELD_SWEEP_H
#define DRAWBAR_HELD_SWEEP_H

#include "kkt.h"

#define HELD 1                             /* side: times -1 at the lower bound, 1 at the upper */
#define BEYOND 2                           /* and given way */

static inline double held_limit(const struct qp *s, const struct held_set *h, int i)
{
    return h->side[i] < 0 ? s->lower[i] : s->upper[i];
}

/* The stage of the input that a bound speaks of: its own, or that which leads to its state. */
static inline int held_stage(const struct qp *s, int i)
{
    const int at = s->bound[i];
    return at < (N + 1) * NX ? at / NX - 1 : (at - (N + 1) * NX) / NU;
}

/* The input that bound i speaks of; -1 when there is none, or not one alone. */
static inline int held_input(const struct qp *s, int i)
{
    const int at = s->bound[i], k = held_stage(s, i), j = at % NX;
    int input = -1;

    if (at >= (N + 1) * NX)
        return (at - (N + 1) * NX) % NU;
    if (k < 0 || j >= ND)
        return -1;
    for (int a = 0; a < NU; ++a)
        if (s->B[k][j][a] != 0.0)
            input = input < 0 ? a : NU;
    return input < NU ? input : -1;
}

/* Where the recursion begins: what qp_solve left without bounds. */
static void held_begin(const struct qp *restrict s, struct held_set *restrict h)
{
    memset(h->side, 0, sizeof h->side);
    memset(h->by, -1, sizeof h->by);
    h->last = -1;
    for (int k = 0; k <= N; ++k) {
        pack x[PACKS], p[PACKS];
        read_vector(x, STATE(s->z, k));
        read_vector(p, STATE(s->pi, k));
        for (int j = 0; j < NX; ++j)
            add_row(p, -STATE(s->z, k)[j], s->P[k][j]);
        write_row(h->p[k], p);
        for (int a = 0; a < NU && k < N; ++a)
            h->feedforward[k][a] = INPUT(s->z, k)[a] - add_dot(0.0, s->K[k][a], x);
    }
}

/* What the price of those that give way adds to the cost. */
static void held_price(const struct qp *restrict s, struct held_set *restrict h)
{
    memcpy(h->g, s->g, sizeof h->g);
    memset(h->curve, 0, sizeof h->curve);
    for (int i = 0; i < NB; ++i)
        if (h->side[i] == BEYOND || h->side[i] == -BEYOND) {
            const int at = s->bound[i];
            h->curve[at] += s->soft_quadratic[i];
            h->g[at] += (h->side[i] < 0 ? -1.0 : 1.0) * s->soft_linear[i] - s->soft_quadratic[i] * held_limit(s, h, i);
        }
}

/* Hessian and gradient of a stage's inputs, as far as P_{k+1} and p_{k+1} are known. */
struct held_hessian {
    double PA[NX][WIDTH], Hux[NU][WIDTH], Huu[NU][NU], hu[NU];
    double along[WIDTH];                   /* P_{k+1} c + p_{k+1} */
};

static void held_hessian(const struct qp *restrict s, const struct held_set *restrict h, int k,
                         struct held_hessian *restrict H)
{
    const double (*restrict after)[WIDTH] = (const double (*)[WIDTH])s->P[k + 1];
    pack sum[PACKS];

    read_row(sum, h->p[k + 1]);
    for (int j = 0; j < NX; ++j)
        add_row(sum, s->c[k][j], after[j]);
    write_row(H->along, sum);
    UNROLLED for (int i = 0; i < NX; ++i) {
        pack row[PACKS];
        EACH_PACK(b)
            row[b] = mask_from(NA, b) * read_pack(after[i], b);
        UNROLLED for (int m = 0; m < NA; ++m)
            add_row(row, after[i][m], s->A[k][m]);
        write_row(H->PA[i], row);
    }
    UNROLLED for (int a = 0; a < NU; ++a) {
        double BP[WIDTH];
        pack row[PACKS], product[PACKS];
        EACH_PACK(b) {
            row[b] = s->B[k][0][a] * read_pack(H->PA[0], b);
            product[b] = s->B[k][0][a] * read_pack(after[0], b);
        }
        H->hu[a] = INPUT(h->g, k)[a] + s->B[k][0][a] * H->along[0];
        UNROLLED for (int m = 1; m < ND; ++m) {
            add_row(row, s->B[k][m][a], H->PA[m]);
            add_row(product, s->B[k][m][a], after[m]);
            H->hu[a] += s->B[k][m][a] * H->along[m];
        }
        if (CROSS)
            add_row(row, 1.0, s->S[k][a]);
        write_row(H->Hux[a], row);
        write_row(BP, product);
        UNROLLED for (int b = 0; b < NU; ++b) {
            H->Huu[a][b] = s->R[k][a][b];
            UNROLLED for (int m = 0; m < ND; ++m)
                H->Huu[a][b] += BP[m] * s->B[k][m][b];
        }
        H->Huu[a][a] += INPUT(h->curve, k)[a];
    }
}

/* The law of a held input: its row of K and its feedforward. */
static void held_law(const struct qp *restrict s, const struct held_set *restrict h, int k, int a, double *restrict row,
                     double *restrict feedforward)
{
    const int i = h->by[k][a], at = s->bound[i], j = at % NX;
    const double limit = held_limit(s, h, i);

    for (int b = 0; b < WIDTH; ++b)
        row[b] = 0.0;
    *feedforward = limit;
    if (at < (N + 1) * NX) {
        const double per = 1.0 / s->B[k][j][a];
        for (int b = 0; b < NX; ++b)
            row[b] = -per * s->A[k][j][b];
        *feedforward = per * (limit - s->c[k][j]);
    }
}

/* Inputs of a stage: the law of those that are held, the best of the others; returns 0 on failure. */
static int held_inputs(struct qp *restrict s, struct held_set *restrict h, int k, const struct held_hessian *restrict H)
{
    double M[NU][NU], right[NU][WIDTH], u[NU];

    for (int a = 0; a < NU; ++a) {
        if (h->by[k][a] < 0) {
            memcpy(right[a], H->Hux[a], sizeof right[a]);
            u[a] = -H->hu[a];
            continue;
        }
        held_law(s, h, k, a, right[a], &u[a]);
        for (int b = 0; b < WIDTH; ++b)
            right[a][b] = -right[a][b];
    }
    for (int a = 0; a < NU; ++a)
        for (int b = 0; b < NU; ++b) {
            const int apart = h->by[k][a] >= 0 || h->by[k][b] >= 0;
            M[a][b] = apart ? a == b : H->Huu[a][b];
            if (h->by[k][a] >= 0 || h->by[k][b] < 0)
                continue;
            for (int i = 0; i < WIDTH; ++i)
                right[a][i] -= H->Huu[a][b] * right[b][i];
            u[a] -= H->Huu[a][b] * u[b];
        }
    if (!ldl_input((const double (*)[NU])M, s->L[k], s->D[k]))
        return 0;
    feedback_rows((const double (*)[NU])s->L[k], s->D[k], (const double (*)[WIDTH])right, s->K[k]);
    ldl_input_solve((const double (*)[NU])s->L[k], s->D[k], u);
    memcpy(h->feedforward[k], u, sizeof u);
    return 1;
}

/* P_k and p_k under the law of the inputs, which need not be the best one. */
static void held_cost(struct qp *restrict s, struct held_set *restrict h, int k, const struct held_hessian *restrict H)
{
    double rest[NU][WIDTH], left[NU];      /* of the inputs' gradient: zero but where they are held */
    pack sum[PACKS];

    UNROLLED for (int a = 0; a < NU; ++a) {
        pack row[PACKS];
        read_row(row, H->Hux[a]);
        left[a] = H->hu[a];
        UNROLLED for (int b = 0; b < NU; ++b) {
            add_row(row, H->Huu[a][b], s->K[k][b]);
            left[a] += H->Huu[a][b] * h->feedforward[k][b];
        }
        write_row(rest[a], row);
    }
    read_vector(sum, STATE(h->g, k));
    EACH_PACK(b)
        sum[b] += mask_from(NA, b) * read_pack(H->along, b);
    UNROLLED for (int m = 0; m < NA; ++m)
        add_row(sum, H->along[m], s->A[k][m]);
    UNROLLED for (int a = 0; a < NU; ++a) {
        add_row(sum, h->feedforward[k][a], H->Hux[a]);
        add_row(sum, left[a], s->K[k][a]);
    }
    write_row(h->p[k], sum);
    EACH_UPPER_ROW(c, i) {
        pack row[PACKS];
        read_row_from(c, row, s->Q[k][i]);
        if (i >= NA)
            add_row_from(c, row, 1.0, H->PA[i]);
        UNROLLED for (int m = 0; m < NA; ++m)
            add_row_from(c, row, s->A[k][m][i], H->PA[m]);
        UNROLLED for (int a = 0; a < NU; ++a) {
            add_row_from(c, row, H->Hux[a][i], s->K[k][a]);
            add_row_from(c, row, s->K[k][a][i], rest[a]);
        }
        write_row_from(c, s->P[k][i], row);
        s->P[k][i][i] += STATE(h->curve, k)[i];
    }
    mirror(s->P[k]);
}

/* Multipliers of the held bounds: what is left of their inputs' gradients. */
static void held_multipliers(struct qp *restrict s, struct held_set *restrict h)
{
    memset(h->nu, 0, sizeof h->nu);
    for (int k = 0; k <= h->last; ++k)
        for (int a = 0; a < NU; ++a) {
            const int i = h->by[k][a], j = i < 0 ? 0 : s->bound[i] % NX;
            double left = INPUT(s->g, k)[a];
            if (i < 0)
                continue;
            for (int b = 0; b < NU; ++b)
                left += s->R[k][a][b] * INPUT(s->z, k)[b];
            for (int b = 0; CROSS && b < NX; ++b)
                left += s->S[k][a][b] * STATE(s->z, k)[b];
            for (int m = 0; m < ND; ++m)
                left += s->B[k][m][a] * STATE(s->pi, k + 1)[m];
            if (s->bound[i] < (N + 1) * NX) {
                left /= s->B[k][j][a];
                STATE(s->pi, k + 1)[j] -= left;
            }
            h->nu[i] = left;
        }
}

/* How fast the variable of a bound moves with the input that the bound speaks of. */
static inline double held_lead(const struct qp *s, int i, int k, int a)
{
    return s->bound[i] < (N + 1) * NX ? s->B[k][s->bound[i] % NX][a] : 1.0;
}

/* The price of bound i, which gives way from now on: to the costs at stage k, from which the recursion has not gone on. */
static void held_give_way(struct qp *restrict s, struct held_set *restrict h, int i, int k)
{
    const int at = s->bound[i], sign = h->side[i] < 0 ? -1 : 1;
    const double slope = sign * s->soft_linear[i] - s->soft_quadratic[i] * held_limit(s, h, i);

    h->side[i] = sign * BEYOND;
    h->g[at] += slope;
    h->curve[at] += s->soft_quadratic[i];
    if (at < (N + 1) * NX) {
        h->p[k + 1][at % NX] += slope;
        s->P[k + 1][at % NX][at % NX] += s->soft_quadratic[i];
    }
}

/* Let go of bounds that hold inputs of a stage back from where the cost falls, and let give way what costs more to hold than
 * its price: the trajectory is where they hold it. Returns how many; *gave_way: the stage's Hessian is another one then. */
static int held_release(struct qp *restrict s, struct held_set *restrict h, int k, const struct held_hessian *restrict H,
                        int *restrict gave_way)
{
    int changes = 0;
    pack x[PACKS];

    read_vector(x, STATE(s->z, k));
    *gave_way = 0;
    for (int a = 0; a < NU && !*gave_way; ++a) {
        const int i = h->by[k][a];
        if (i < 0)
            continue;
        double slope = add_dot(H->hu[a], H->Hux[a], x);
        for (int b = 0; b < NU; ++b)
            slope += H->Huu[a][b] * INPUT(s->z, k)[b];
        const double pull = -slope * h->side[i] / held_lead(s, i, k, a);
        *gave_way = pull > s->soft_linear[i];
        if (*gave_way)
            held_give_way(s, h, i, k);
        else if (pull < 0.0 && s->lower[i] < s->upper[i])
            h->side[i] = 0;
        else
            continue;
        h->by[k][a] = -1;
        ++changes;
    }
    return changes;
}

/* Backward from the last bound that was ever held: releases, laws and costs to go. Returns how many bounds were released, or
 * -1 on failure. */
static int held_backward(struct qp *restrict s, struct held_set *restrict h)
{
    struct held_hessian H ON_STACK;
    int changes = 0;

    held_price(s, h);
    if (h->last == N - 1) {
        memcpy(s->P[N], s->Q[N], sizeof s->P[N]);
        for (int i = 0; i < NX; ++i) {
            s->P[N][i][i] += STATE(h->curve, N)[i];
            h->p[N][i] = STATE(h->g, N)[i];
        }
    }
    for (int k = h->last < N - 1 ? h->last + 1 : N - 1; k >= 0; --k) {
        for (int a = 0, again = 1; a <= NU && again; ++a) {
            held_hessian(s, h, k, &H);
            changes += held_release(s, h, k, &H, &again);
        }
        if (!held_inputs(s, h, k, &H))
            return -1;
        held_cost(s, h, k, &H);
    }
    return changes;
}

#endif
