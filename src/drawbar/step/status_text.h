/* What a status of an exported library means, in one line. */
#ifndef DRAWBAR_STATUS_TEXT_H
#define DRAWBAR_STATUS_TEXT_H

#include "drawbar.h"

const char *drawbar_status_text(int status)
{
    switch (status) {
    case DRAWBAR_OK:
        return "a new command";
    case DRAWBAR_MEASUREMENT:
        return "a new command; a measured value was infinite or absurd and was taken for missing";
    case DRAWBAR_LATE:
        return "a new command; a sample or more was left out";
    case DRAWBAR_LIMITED:
        return "a new command; its steering was brought nearer to the wheels, by what no actuator can tell";
    case DRAWBAR_SOLVER:
        return "a new command; a solver failed, its estimate or plan is a prediction";
    case DRAWBAR_REFUSED:
        return "last command repeated: the new one was not finite or beyond its limits";
    case DRAWBAR_TIME:
        return "last command repeated: the time stamp is not finite or does not increase";
    case DRAWBAR_POSITION:
        return "standing: the run cannot begin, an antenna's position is missing";
    case DRAWBAR_START:
        return "standing: the run cannot begin, the tractor is too far from the path's start";
    case DRAWBAR_FINISHED:
        return "stopped: the tractor has reached the end of the path";
    case DRAWBAR_OFF_COURSE:
        return "stopped: the tractor is too far from the path";
    case DRAWBAR_BLIND:
        return "stopped: neither antenna has had a valid fix for too long";
    case DRAWBAR_GUIDANCE:
        return "stopped: the estimate is not finite, or no way leads back onto the path";
    case DRAWBAR_GAP:
        return "stopped: samples were left out for longer than a command may be repeated";
    case DRAWBAR_STOPPED:
        return "stopped: no command could be given for longer than one may be repeated";
    case DRAWBAR_NULL:
        return "wrong call: a pointer is NULL";
    case DRAWBAR_NOT_INITIALISED:
        return "wrong call: drawbar_init has not been called on this state";
    case DRAWBAR_NO_PATH:
        return "wrong call: drawbar_set_path has not been called, or not with success";
    case DRAWBAR_ORDER:
        return "wrong call: feedback and prepare do not alternate";
    case DRAWBAR_PATH:
        return "wrong call: the path's table is not a smooth path";
    default:
        return "no status of this library";
    }
}

#endif
