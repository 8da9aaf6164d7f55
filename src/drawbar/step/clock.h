/* Clock that only goes forward, its time in ns; for measurements of Python's own library alone. */
#ifndef DRAWBAR_CLOCK_H
#define DRAWBAR_CLOCK_H

#include <stdint.h>

#ifdef _WIN32
#include <windows.h>

static inline int64_t clock_now(void)
{
    LARGE_INTEGER count, frequency;
    QueryPerformanceCounter(&count);
    QueryPerformanceFrequency(&frequency);
    return (int64_t)(1e9 * (double)count.QuadPart / (double)frequency.QuadPart);
}
#else
#include <time.h>

static inline int64_t clock_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1000000000 * (int64_t)t.tv_sec + (int64_t)t.tv_nsec;
}
#endif

#endif
