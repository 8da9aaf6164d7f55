/* The time of a clock that only goes forward, s; for measurements of Python's own library alone. */
#ifndef DRAWBAR_CLOCK_H
#define DRAWBAR_CLOCK_H

#ifdef _WIN32
#include <windows.h>

static inline double clock_now(void)
{
    LARGE_INTEGER count, frequency;
    QueryPerformanceCounter(&count);
    QueryPerformanceFrequency(&frequency);
    return (double)count.QuadPart / (double)frequency.QuadPart;
}
#else
#include <time.h>

static inline double clock_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
#endif

#endif
