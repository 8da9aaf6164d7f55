/* Status texts: one line for each status.
 *
 * Generated from signals/ and statuses.py by `python -m drawbar.signals.c_headers`; change them there. */
#ifndef DRAWBAR_STATUS_TEXT_H
#define DRAWBAR_STATUS_TEXT_H

#include "drawbar.h"

/* What a status means, in one line. No table: its pointers would be data that a shared library relocates. */
const char *drawbar_status_text(int status)
{
    if (status > DRAWBAR_OK && status < DRAWBAR_REFUSED && (status & (status - 1)) != 0)
        return "a new command; several flags are set";
    switch (status) {
    case DRAWBAR_OK:
        return "done; of a step: with a new command";
    case DRAWBAR_REFUSED:
        return "last command repeated: the new one is not finite or exceeds its limits";
    case DRAWBAR_TIME:
        return "last command repeated: the time stamp is not finite or does not increase";
    case DRAWBAR_POSITION:
        return "standing: the run cannot begin, an antenna's position is missing";
    case DRAWBAR_START:
        return "standing: the run cannot begin, the tractor is too far from where it is to begin on the path";
    case DRAWBAR_FINISHED:
        return "stopped: the tractor has reached the end of the path";
    case DRAWBAR_OFF_COURSE:
        return "stopped: the tractor is too far from the path";
    case DRAWBAR_BLIND:
        return "stopped: neither antenna has had a valid fix for too long";
    case DRAWBAR_GUIDANCE:
        return "stopped: the estimate is not finite, or no turns lead back onto the path";
    case DRAWBAR_GAP:
        return "stopped: samples were left out for longer than a command may be repeated";
    case DRAWBAR_STOPPED:
        return "stopped: no command could be given for longer than one may be repeated";
    case DRAWBAR_UNSOLVED:
        return "stopped: estimator or controllers have had no solution for too long";
    case DRAWBAR_OVERDUE:
        return "stopped: samples came late for too long";
    case DRAWBAR_RATE:
        return "stopped: samples come more often, or less often, than every sample_time";
    case DRAWBAR_COARSE:
        return "stopped: positions have been coarse for too long";
    case DRAWBAR_OSCILLATION:
        return "stopped: errors or steering swing from side to side";
    case DRAWBAR_BACKWARDS:
        return "stopped: both antennas move backwards: they are swapped, or the vehicle is driven in reverse";
    case DRAWBAR_STEERING:
        return "stopped: a steering does not follow its commands: sensor or actuator fails, or somebody steers";
    case DRAWBAR_HITCH:
        return "stopped: the hitch angle contradicts the motion of both bodies";
    case DRAWBAR_ROLL:
        return "stopped: a roll sensor contradicts the other angles or the swing of its antenna: it is reversed or stuck";
    case DRAWBAR_JUMPED:
        return "stopped: both positions have jumped: base station or solution changed, receivers swapped, or vehicle slides";
    case DRAWBAR_NULL:
        return "wrong call: a pointer is NULL";
    case DRAWBAR_NOT_INITIALISED:
        return "wrong call: drawbar_init has not been called on this state";
    case DRAWBAR_NO_PATH:
        return "wrong call: drawbar_set_path has not been called, or not with success";
    case DRAWBAR_ORDER:
        return "wrong call: out of order: feedback and prepare alternate, and a run's start is set before it begins";
    case DRAWBAR_PATH:
        return "wrong call: the path's table is not a smooth path";
    case DRAWBAR_RANGE:
        return "wrong call: a number is beyond what is allowed";
    case DRAWBAR_NO_RUN:
        return "wrong call: no run has begun, or it has ended";
    case DRAWBAR_ELSEWHERE:
        return "wrong call: the vehicle is not on the new path at that place, or faces away from it";
    case DRAWBAR_UNALIGNED:
        return "wrong call: a pointer is not aligned as a double";
    case DRAWBAR_ARITHMETIC:
        return "wrong build: NaN or sums are not IEEE's";
    case DRAWBAR_MEASUREMENT:
        return "a new command; a measured value was infinite or beyond what its sensor can mean, and was taken for missing";
    case DRAWBAR_LATE:
        return "a new command; one or more samples were left out";
    case DRAWBAR_LIMITED:
        return "a new command; steering clamped where the valve is already fully open; the motion is unchanged";
    case DRAWBAR_SOLVER:
        return "a new command; a solver failed; the estimate or the plan is its own prediction";
    case DRAWBAR_SLOWED:
        return "a new command; the vehicle is driven slower than the set speed, until estimates and plans are sound again";
    case DRAWBAR_RELEASED:
        return "a new command; not engaged: the command repeats the steering as it is, with speed zero";
    default:
        return "no status of this library";
    }
}

#endif
