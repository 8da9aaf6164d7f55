/* Held set: projected Newton (Bertsekas 1982) along the stages (Tassa, Mansard and Todorov 2014), on factorisations in which
 * held inputs have no choice left (held_sweep.h).
 *
 * A pass goes backward, where the cost's slope lets bounds go that need not be held, and forward, where each input goes no
 * further than its own bound and those of the states that it leads to allow: what comes later starts from where the bounds
 * before it let it get, so that many change at once and most problems need one pass or two. A pass costs one
 * factorisation and one sweep of the stages up to the last bound, however many bounds are active. A soft bound whose
 * multiplier would exceed its price gives way, or where what goes before it leaves no choice. Bounds of a kind that no
 * single input answers for are left to active_set.h, and what does not settle to interior_point.h.
 */
#ifndef DRAWBAR_HELD_SET_H
#define DRAWBAR_HELD_SET_H

#include "held_sweep.h"

#define HELD_PASSES 8
#define KEPT_PASSES 5                      /* with bounds that are kept (held_again.h): the first is two sweeps alone */

/* Where an input may go: low to high, and which bounds say so, -1 for none. */
struct held_room {
    double low, high;
    int by_low, by_high;
};

/* Chain the bounds that speak of each input, its own before those of states, and those that no single one answers for. */
static void held_chain(const struct qp *restrict s, struct held_set *restrict h)
{
    memset(h->first, -1, sizeof h->first);
    h->foreign = -1;
    for (int i = 0; i < NB; ++i) {
        const int a = held_input(s, i), k = held_stage(s, i), own = s->bound[i] >= (N + 1) * NX;
        int32_t *place = a < 0 ? &h->foreign : &h->first[k][a];
        if (!own && *place >= 0 && s->bound[*place] >= (N + 1) * NX)
            place = &h->next[*place];
        h->next[i] = *place;
        *place = i;
    }
}

/* Take in what bound i leaves of an input's room, which moves the variable from `base` by `lead`. Returns what becomes of the
 * bound if no input ends at it: 0, or BEYOND with the sign of its side; HELD where it is hard and leaves nothing. */
static inline int held_narrow(const struct qp *s, int i, int side, double base, double lead, struct held_room *room)
{
    const double per = 1.0 / lead, lower = per * (s->lower[i] - base), upper = per * (s->upper[i] - base);
    const int outward = lead > 0.0 ? 1 : -1, beyond = side == BEYOND ? outward : side == -BEYOND ? -outward : 0;
    double low = outward > 0 ? lower : upper, high = outward > 0 ? upper : lower;

    if (beyond > 0) {                      /* it may come back as far as to its limit */
        low = high;
        high = (double)INFINITY;
    } else if (beyond < 0) {
        high = low;
        low = -(double)INFINITY;
    }
    if (low > room->high || high < room->low) {
        const int past = low > room->high ? -outward : outward;
        return beyond != 0 ? 0 : s->soft_linear[i] < (double)INFINITY ? past * BEYOND : HELD;
    }
    if (low > room->low) {
        room->low = low;
        room->by_low = i;
    }
    if (high < room->high) {
        room->high = high;
        room->by_high = i;
    }
    return beyond * outward * BEYOND;
}

/* What the variable of a bound is before an input moves it: 0 for the input itself. */
static inline double held_base(const struct qp *s, int i, int k, const pack *x)
{
    const int j = s->bound[i] % NX;

    if (s->bound[i] >= (N + 1) * NX)
        return 0.0;
    return j < NA ? add_dot(s->c[k][j], s->A[k][j], x) : s->c[k][j] + STATE(s->z, k)[j];
}

/* Does an input respect all its bounds where its law leads, and are none beyond their limits? */
static inline int held_stays(const struct qp *s, const struct held_set *h, int k, int a, const pack *x, double u)
{
    for (int i = h->first[k][a]; i >= 0; i = h->next[i]) {
        if (i == h->by[k][a])
            continue;
        const double value = held_base(s, i, k, x) + held_lead(s, i, k, a) * u;
        if (h->side[i] != 0 || value < s->lower[i] || value > s->upper[i])
            return 0;
    }
    return 1;
}

/* Release an input that its bound holds back from where the cost falls, as the way forward has led to this state: of bounds in a
 * row, all that have to go after the first do so in one pass. The way goes on from the input's best. */
static inline void held_drop(const struct qp *s, struct held_set *h, int k, int a, const pack *x, double *u)
{
    const int i = h->by[k][a];

    if (i < 0)
        return;
    const double left = add_dot(h->left[k][a], h->rest[k][a], x);
    if (left * h->side[i] * held_lead(s, i, k, a) > 0.0 && s->lower[i] < s->upper[i]) {
        h->by[k][a] = -1;
        *u -= left / h->stiffness[k][a];
    }
}

/* Bring an input to where it may be. Returns how many of its bounds have changed, or -1 where a hard one leaves no room. */
static int held_clip(const struct qp *restrict s, struct held_set *restrict h, int k, int a, const pack *x, double *restrict u)
{
    struct held_room room = {-(double)INFINITY, (double)INFINITY, -1, -1};
    int changes = 0, end = 0, by = h->by[k][a];

    for (int i = h->first[k][a]; i >= 0; i = h->next[i]) {
        h->becomes[i] = held_narrow(s, i, h->side[i], held_base(s, i, k, x), held_lead(s, i, k, a), &room);
        if (h->becomes[i] == HELD)
            return -1;
    }
    if (by >= 0)                           /* its law brings the input to the bound, but for rounding */
        end = (h->side[by] > 0) == (held_lead(s, by, k, a) > 0.0) ? 1 : -1;
    if (by < 0 || by != (end > 0 ? room.by_high : room.by_low))
        end = *u > room.high ? 1 : *u < room.low ? -1 : 0;
    h->by[k][a] = by = end > 0 ? room.by_high : end < 0 ? room.by_low : -1;
    *u = end > 0 ? room.high : end < 0 ? room.low : *u;
    if (by >= 0) {                         /* one that comes back from beyond keeps its side */
        const int upper = h->becomes[by] != 0 ? h->becomes[by] > 0 : (end > 0) == (held_lead(s, by, k, a) > 0.0);
        h->becomes[by] = upper ? HELD : -HELD;
    }
    for (int i = h->first[k][a]; i >= 0; i = h->next[i]) {
        changes += h->becomes[i] != h->side[i];
        h->side[i] = h->becomes[i];
        h->last = h->side[i] != 0 && k > h->last ? k : h->last;
    }
    return changes;
}

/* Forward by the laws, with every input within its room, and multipliers of the costs to go; may_release: after a backward
 * sweep, which has computed held inputs' gradients. Returns how many bounds have changed, or -1 where one is violated that
 * cannot be held here. */
static int held_forward(struct qp *restrict s, struct held_set *restrict h, int may_release)
{
    double now[NX];
    int changes = 0;

    memcpy(now, s->initial, sizeof now);
    for (int k = 0; k <= N; ++k) {
        double *u = INPUT(s->z, k);
        pack x[PACKS];
        state_and_multiplier(s, k, now, h->p[k], x, s->z, s->pi);
        for (int a = 0; a < NU && k < N; ++a) {
            u[a] = add_dot(h->feedforward[k][a], s->K[k][a], x);
            if (may_release)
                held_drop(s, h, k, a, x, &u[a]);
            const int changed = held_stays(s, h, k, a, x, u[a]) ? 0 : held_clip(s, h, k, a, x, &u[a]);
            if (changed < 0)
                return -1;
            changes += changed;
        }
        if (k < N)
            state_after(s, k, s->c[k], x, u, now);
    }
    for (int i = h->foreign; i >= 0; i = h->next[i])
        if (s->z[s->bound[i]] < s->lower[i] || s->z[s->bound[i]] > s->upper[i])
            return -1;
    return changes;
}

/* Is the multiplier of every bound that is held of the right sign, and below its price? The laws have moved what is before
 * it since the slopes were looked at. */
static int held_right(struct qp *restrict s, struct held_set *restrict h)
{
    int right = 1;

    held_multipliers(s, h);
    for (int i = 0; i < NB; ++i) {
        const double pull = -h->side[i] * h->nu[i];
        right &= (pull >= 0.0 || !(s->lower[i] < s->upper[i])) && pull <= s->soft_linear[i];
    }
    return right;
}

static void held_publish(struct qp *restrict s, const struct held_set *restrict h)
{
    for (int i = 0; i < NB; ++i) {
        if (h->side[i] == 0)
            continue;
        const int beyond = h->side[i] == BEYOND || h->side[i] == -BEYOND, lower = 2 * i, upper = 2 * i + 1;
        const double violation = fabs(s->z[s->bound[i]] - held_limit(s, h, i));
        s->multiplier[lower] = h->nu[i] > 0.0 ? h->nu[i] : 0.0;
        s->multiplier[upper] = h->nu[i] < 0.0 ? -h->nu[i] : 0.0;
        if (beyond) {
            const int m = h->side[i] < 0 ? lower : upper;
            s->multiplier[m] = s->soft_linear[i] + s->soft_quadratic[i] * violation;
            s->violation[m] = violation;
        }
    }
}

enum held_outcome { HELD_SETTLED, HELD_UNSETTLED, HELD_FOREIGN };

/* Tell what is held, if that is the solution. */
static int held_settled(struct qp *restrict s, struct held_set *restrict h)
{
    if (!held_right(s, h))
        return 0;
    held_publish(s, h);
    return 1;
}

/* Pass after pass until nothing changes, from a sweep forward that has changed so many bounds (-1: it cannot go on). Counts
 * them by s->iterations. Begun with bounds that are kept, the way forward lets inputs go too; with none, few are held that have
 * to go, and without it more settle. */
static enum held_outcome held_settle(struct qp *s, struct held_set *h, int changes, int kept)
{
    while (changes >= 0 && s->iterations++ < (kept ? KEPT_PASSES : HELD_PASSES)) {
        changes = held_backward(s, h) ? held_forward(s, h, kept) : -1;
        if (changes == 0 && held_settled(s, h))
            return HELD_SETTLED;
    }
    return HELD_UNSETTLED;
}

#endif
