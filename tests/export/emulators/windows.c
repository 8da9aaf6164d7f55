/* The host's files on Windows, and its start, without a C library: the wheel would build mingw's first, for a minute. */
#include <stdint.h>
#include "host.h"

#define READ 0x80000000u
#define WRITE 0x40000000u
#define OPEN 3u
#define CREATE 2u

__declspec(dllimport) void *CreateFileA(const char *name, uint32_t access, uint32_t share, void *security,
                                        uint32_t creation, uint32_t attributes, void *like);
__declspec(dllimport) int ReadFile(void *file, void *bytes, uint32_t size, uint32_t *read, void *overlapped);
__declspec(dllimport) int WriteFile(void *file, const void *bytes, uint32_t size, uint32_t *written, void *overlapped);
__declspec(dllimport) _Noreturn void ExitProcess(uint32_t code);

int main(void);
void __main(void); /* mingw's compilers call it as main begins */
_Noreturn void mainCRTStartup(void);

static void *input, *output;

int host_read(void *bytes, size_t size)
{
    uint32_t read = 0;
    if (!input)
        input = CreateFileA("input", READ, 0, NULL, OPEN, 0, NULL);
    return ReadFile(input, bytes, (uint32_t)size, &read, NULL) && read == size;
}

void host_begin(void)
{
}

void host_end(void)
{
}

int host_write(const void *bytes, size_t size)
{
    uint32_t written = 0;
    if (!output)
        output = CreateFileA("output", WRITE, 0, NULL, CREATE, 0, NULL);
    return WriteFile(output, bytes, (uint32_t)size, &written, NULL) && written == size;
}

void __main(void)
{
}

void mainCRTStartup(void)
{
    ExitProcess((uint32_t)main());
}
