/* One stage of the Riccati recursion of projected_newton.h, in which inputs with an active bound follow that bound's law.
 *
 * An active bound determines one input of its stage k: a bound on the input, u_a = bound; a bound on a state that this input
 * alone moves, x_{k+1,j} = bound, by u_a = (bound - c_j - A_j x) / B_ja. The recursion evaluates this law instead of the
 * optimal one.
 */
#ifndef DRAWBAR_PN_STAGE_H
#define DRAWBAR_PN_STAGE_H

#include "kkt.h"

static inline double pn_limit(const struct qp *s, const struct projected_newton *pn, int i)
{
    return pn->side[i] < 0 ? s->lower[i] : s->upper[i];
}

/* The stage whose input moves a bounded variable: its own, or the one before its state. */
static inline int pn_stage_of(const struct qp *s, int i)
{
    const int at = s->bound[i];
    return at < (N + 1) * NX ? at / NX - 1 : (at - (N + 1) * NX) / NU;
}

/* The input that alone moves bounded variable i; -1 where there is none (a coupled bound). */
static inline int pn_input_of(const struct qp *s, int i)
{
    const int at = s->bound[i], k = pn_stage_of(s, i), j = at % NX;
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
struct pn_hessian {
    double PA[NX][WIDTH], BP[NU][WIDTH], Hux[NU][WIDTH], Huu[NU][NU], hu[NU];
    double costate[WIDTH];                 /* P_{k+1} c + p_{k+1} */
};

/* The Hessian; penalty: what the penalties of violated bounds add to its diagonal, or NULL. */
static void pn_form_hessian(const struct qp *restrict s, const double *restrict penalty, int k, struct pn_hessian *restrict H)
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
        if (penalty)
            H->Huu[a][a] += INPUT(penalty, k)[a];
    }
}

/* Costate at stage k + 1: P_{k+1} defect + p_{k+1}. */
static inline void pn_costate(const struct qp *restrict s, const double *restrict after, int k, const double *restrict defect,
                              double *restrict costate)
{
    pack sum[PACKS];

    read_row(sum, after);
    for (int j = 0; j < NX; ++j)
        add_row(sum, defect[j], s->P[k + 1][j]);
    write_row(costate, sum);
}

/* Gradient of input a at u = 0. */
static inline double pn_input_gradient(const struct qp *restrict s, const double *restrict g, int k, int a,
                                       const double *restrict costate)
{
    double gradient = INPUT(g, k)[a];

    UNROLLED for (int m = 0; m < ND; ++m)
        gradient += s->B[k][m][a] * costate[m];
    return gradient;
}

/* Constant part of the law of an active bound; inverse: of pn_inverse_input. */
static inline double pn_offset(const struct qp *restrict s, int at, int k, double inverse, double limit)
{
    return at < (N + 1) * NX ? inverse * (limit - s->c[k][at % NX]) : limit;
}

/* 1 / B_ja where a bound on a state is active, 0 where one on the input is. */
static inline double pn_inverse_input(const struct qp *restrict s, int at, int k, int a)
{
    return at < (N + 1) * NX ? 1.0 / s->B[k][at % NX][a] : 0.0;
}

/* Gains of a stage's inputs: the laws of active bounds, and the optimal ones of the others. at: index into z of the variable
 * that is at its limit for each input, -1 for none; offset: of pn_offset. Returns 0 on failure. */
static int pn_gains(struct qp *restrict s, int k, const int *restrict at, const double *restrict limit,
                      const struct pn_hessian *restrict H, double *restrict offset)
{
    double M[NU][NU], right[NU][WIDTH];

    for (int a = 0; a < NU; ++a) {
        if (at[a] < 0) {
            memcpy(right[a], H->Hux[a], sizeof right[a]);
            offset[a] = 0.0;
            continue;
        }
        const double inverse = pn_inverse_input(s, at[a], k, a);
        offset[a] = pn_offset(s, at[a], k, inverse, limit[a]);
        for (int b = 0; b < WIDTH; ++b)
            right[a][b] = 0.0;
        for (int b = 0; b < NX && at[a] < (N + 1) * NX; ++b)
            right[a][b] = inverse * s->A[k][at[a] % NX][b];   /* less the law's row of K */
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

/* P_k under these gains, which need not be optimal; penalty as in pn_form_hessian. gradient_gain: derivative of the inputs'
 * gradients by the state, zero where no bound is active. */
static void pn_cost_to_go(struct qp *restrict s, const double *restrict penalty, int k, const struct pn_hessian *restrict H,
                          double (*restrict gradient_gain)[WIDTH])
{
    UNROLLED for (int a = 0; a < NU; ++a) {
        pack row[PACKS];
        read_row(row, H->Hux[a]);
        UNROLLED for (int b = 0; b < NU; ++b)
            add_row(row, H->Huu[a][b], s->K[k][b]);
        write_row(gradient_gain[a], row);
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
            add_row_from(c, row, s->K[k][a][i], gradient_gain[a]);
        }
        write_row_from(c, s->P[k][i], row);
        if (penalty)
            s->P[k][i][i] += STATE(penalty, k)[i];
    }
    mirror(s->P[k]);
}

/* Feedforward of a stage's inputs, and p_k; costate and gradient: at x = 0, with the inputs of active bounds at their offsets. */
static inline void pn_vectors(const struct qp *restrict s, struct projected_newton *restrict pn, int k,
                              const double *restrict costate, const double *restrict gradient, const double *restrict offset)
{
    pack sum[PACKS];

    read_vector(sum, STATE(pn->g, k));
    EACH_PACK(b)
        sum[b] += mask_from(NA, b) * read_pack(costate, b);
    UNROLLED for (int m = 0; m < NA; ++m)
        add_row(sum, costate[m], s->A[k][m]);
    UNROLLED for (int a = 0; a < NU; ++a) {
        pn->feedforward[k][a] = pn->active[k][a] < 0 ? -gradient[a] : offset[a];
        add_row(sum, gradient[a], s->K[k][a]);
        if (CROSS)
            add_row(sum, offset[a], s->S[k][a]);
    }
    write_row(pn->p[k], sum);
    ldl_input_solve((const double (*)[NU])s->L[k], s->D[k], pn->feedforward[k]);
}

/* pn_vectors by the stage's Hessian; its gradients are given at u = 0, and moved to the offsets. */
static inline void pn_vectors_by_hessian(const struct qp *restrict s, struct projected_newton *restrict pn, int k,
                                         const double *restrict offset, struct pn_hessian *restrict H)
{
    pack sum[PACKS];

    read_row(sum, H->costate);
    UNROLLED for (int b = 0; b < NU; ++b) {
        add_row(sum, offset[b], H->BP[b]);
        UNROLLED for (int a = 0; a < NU; ++a)
            H->hu[a] += H->Huu[a][b] * offset[b];
    }
    write_row(H->costate, sum);
    pn_vectors(s, pn, k, H->costate, H->hu, offset);
}

/* Derivative of a bounded variable by the input that alone moves it. */
static inline double pn_sensitivity(const struct qp *s, int i, int k, int a)
{
    return s->bound[i] < (N + 1) * NX ? s->B[k][s->bound[i] % NX][a] : 1.0;
}

/* Store the gradients of a stage's inputs under the laws at x = 0, and their curvatures. */
static inline void pn_store_gradients(struct projected_newton *restrict pn, int k, const struct pn_hessian *restrict H)
{
    UNROLLED for (int a = 0; a < NU; ++a) {
        pn->gradient_offset[k][a] = H->hu[a];
        for (int b = 0; b < NU; ++b)
            pn->gradient_offset[k][a] += pn->active[k][b] < 0 ? H->Huu[a][b] * pn->feedforward[k][b] : 0.0;
        pn->curvature[k][a] = H->Huu[a][a];
    }
}

#endif
