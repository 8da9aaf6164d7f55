/* Held stage: one stage of the Riccati recursion in which held inputs have no choice left.
 *
 * A bound that is held at stage k says what one input of that stage does: that of an input by itself, u_a = bound; that of
 * a state which this input alone moves, x_{k+1,j} = bound, by u_a = (bound - c_j - A_j x) / B_ja. The recursion goes on with
 * this law in the place of the optimal one.
 */
#ifndef DRAWBAR_HELD_STAGE_H
#define DRAWBAR_HELD_STAGE_H

#include "kkt.h"

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

/* Hessian and gradient of a stage's inputs, as far as P_{k+1} and p_{k+1} are known. */
struct held_hessian {
    double PA[NX][WIDTH], BP[NU][WIDTH], Hux[NU][WIDTH], Huu[NU][NU], hu[NU];
    double along[WIDTH];                   /* P_{k+1} c + p_{k+1} */
};

/* The Hessian; curve: what prices add to its diagonal, or NULL. */
static void held_hessian(const struct qp *restrict s, const double *restrict curve, int k, struct held_hessian *restrict H)
{
    const double (*restrict after)[WIDTH] = (const double (*)[WIDTH])s->P[k + 1];

    UNROLLED for (int i = 0; i < NX; ++i) {
        pack row[PACKS];
        EACH_PACK(b)
            row[b] = mask_from(NA, b) * read_pack(after[i], b);
        UNROLLED for (int m = 0; m < NA; ++m)
            add_row(row, after[i][m], s->A[k][m]);
        write_row(H->PA[i], row);
    }
    UNROLLED for (int a = 0; a < NU; ++a) {
        pack row[PACKS], product[PACKS];
        EACH_PACK(b) {
            row[b] = s->B[k][0][a] * read_pack(H->PA[0], b);
            product[b] = s->B[k][0][a] * read_pack(after[0], b);
        }
        UNROLLED for (int m = 1; m < ND; ++m) {
            add_row(row, s->B[k][m][a], H->PA[m]);
            add_row(product, s->B[k][m][a], after[m]);
        }
        if (CROSS)
            add_row(row, 1.0, s->S[k][a]);
        write_row(H->Hux[a], row);
        write_row(H->BP[a], product);
        UNROLLED for (int b = 0; b < NU; ++b) {
            H->Huu[a][b] = s->R[k][a][b];
            UNROLLED for (int m = 0; m < ND; ++m)
                H->Huu[a][b] += H->BP[a][m] * s->B[k][m][b];
        }
        if (curve)
            H->Huu[a][a] += INPUT(curve, k)[a];
    }
}

/* P_{k+1} times a defect, and p_{k+1}. */
static inline void held_along(const struct qp *restrict s, const double *restrict after, int k, const double *restrict defect,
                              double *restrict along)
{
    pack sum[PACKS];

    read_row(sum, after);
    for (int j = 0; j < NX; ++j)
        add_row(sum, defect[j], s->P[k + 1][j]);
    write_row(along, sum);
}

/* The gradient, of which input a has this part where none moves. */
static inline double held_slope(const struct qp *restrict s, const double *restrict g, int k, int a, const double *restrict along)
{
    double slope = INPUT(g, k)[a];

    UNROLLED for (int m = 0; m < ND; ++m)
        slope += s->B[k][m][a] * along[m];
    return slope;
}

/* What the bound that holds an input asks of it before the law's part, which goes by `per`: 1 / B where it is a state's. */
static inline double held_asks(const struct qp *restrict s, int at, int k, double per, double limit)
{
    return at < (N + 1) * NX ? per * (limit - s->c[k][at % NX]) : limit;
}

static inline double held_per(const struct qp *restrict s, int at, int k, int a)
{
    return at < (N + 1) * NX ? 1.0 / s->B[k][at % NX][a] : 0.0;
}

/* Gains of a stage's inputs, of which those with a place in z are held at a limit of what is there (-1: not): the law of
 * these, the best of the others; returns 0 on failure. asked: as of held_asks. */
static int held_gains(struct qp *restrict s, int k, const int *restrict at, const double *restrict limit,
                      const struct held_hessian *restrict H, double *restrict asked)
{
    double M[NU][NU], right[NU][WIDTH];

    for (int a = 0; a < NU; ++a) {
        if (at[a] < 0) {
            memcpy(right[a], H->Hux[a], sizeof right[a]);
            asked[a] = 0.0;
            continue;
        }
        const double per = held_per(s, at[a], k, a);
        asked[a] = held_asks(s, at[a], k, per, limit[a]);
        for (int b = 0; b < WIDTH; ++b)
            right[a][b] = 0.0;
        for (int b = 0; b < NX && at[a] < (N + 1) * NX; ++b)
            right[a][b] = per * s->A[k][at[a] % NX][b];   /* less the law's row of K */
    }
    for (int a = 0; a < NU; ++a)
        for (int b = 0; b < NU; ++b) {
            const int apart = at[a] >= 0 || at[b] >= 0;
            M[a][b] = apart ? a == b : H->Huu[a][b];
            if (at[a] >= 0 || at[b] < 0)
                continue;
            for (int i = 0; i < WIDTH; ++i)
                right[a][i] -= H->Huu[a][b] * right[b][i];
        }
    if (!ldl_input((const double (*)[NU])M, s->L[k], s->D[k]))
        return 0;
    feedback_rows((const double (*)[NU])s->L[k], s->D[k], (const double (*)[WIDTH])right, s->K[k]);
    return 1;
}

/* P_k under these gains, which need not be the best ones; curve as in held_hessian. rest: how the inputs' gradients go with the
 * state: zero but where they are held. */
static void held_cost(struct qp *restrict s, const double *restrict curve, int k, const struct held_hessian *restrict H,
                      double (*restrict rest)[WIDTH])
{
    UNROLLED for (int a = 0; a < NU; ++a) {
        pack row[PACKS];
        read_row(row, H->Hux[a]);
        UNROLLED for (int b = 0; b < NU; ++b)
            add_row(row, H->Huu[a][b], s->K[k][b]);
        write_row(rest[a], row);
    }
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
        if (curve)
            s->P[k][i][i] += STATE(curve, k)[i];
    }
    mirror(s->P[k]);
}

/* Feedforward of a stage's inputs, and p_k. Held inputs do what is asked of them, the others their best; along: the gradient
 * of the cost to go where the held ones lead, slope: of the inputs there. */
static inline void held_vectors(const struct qp *restrict s, struct held_set *restrict h, int k, const double *restrict along,
                                const double *restrict slope, const double *restrict asked)
{
    pack sum[PACKS];

    read_vector(sum, STATE(h->g, k));
    EACH_PACK(b)
        sum[b] += mask_from(NA, b) * read_pack(along, b);
    UNROLLED for (int m = 0; m < NA; ++m)
        add_row(sum, along[m], s->A[k][m]);
    UNROLLED for (int a = 0; a < NU; ++a) {
        h->feedforward[k][a] = h->by[k][a] < 0 ? -slope[a] : asked[a];
        add_row(sum, slope[a], s->K[k][a]);
        if (CROSS)
            add_row(sum, asked[a], s->S[k][a]);
    }
    write_row(h->p[k], sum);
    ldl_input_solve((const double (*)[NU])s->L[k], s->D[k], h->feedforward[k]);
}

/* held_vectors by the stage's Hessian and gradients, which are those where no input moves, and are moved on. */
static inline void held_vectors_by_hessian(const struct qp *restrict s, struct held_set *restrict h, int k,
                                           const double *restrict asked, struct held_hessian *restrict H)
{
    pack sum[PACKS];

    read_row(sum, H->along);
    UNROLLED for (int b = 0; b < NU; ++b) {
        add_row(sum, asked[b], H->BP[b]);
        UNROLLED for (int a = 0; a < NU; ++a)
            H->hu[a] += H->Huu[a][b] * asked[b];
    }
    write_row(H->along, sum);
    held_vectors(s, h, k, H->along, H->hu, asked);
}

/* How fast the variable of a bound moves with the input that the bound speaks of. */
static inline double held_lead(const struct qp *s, int i, int k, int a)
{
    return s->bound[i] < (N + 1) * NX ? s->B[k][s->bound[i] % NX][a] : 1.0;
}

/* What the gradients of a stage's held inputs are under the laws where the state is zero, and how stiff these are. */
static inline void held_left(struct held_set *restrict h, int k, const struct held_hessian *restrict H)
{
    UNROLLED for (int a = 0; a < NU; ++a) {
        h->left[k][a] = H->hu[a];
        for (int b = 0; b < NU; ++b)
            h->left[k][a] += h->by[k][b] < 0 ? H->Huu[a][b] * h->feedforward[k][b] : 0.0;
        h->stiffness[k][a] = H->Huu[a][a];
    }
}

#endif
