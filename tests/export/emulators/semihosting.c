/* Start, files and end of a program on a bare Cortex-M, through the debugger's semihosting calls (Arm, "Semihosting for
 * AArch32 and AArch64"). Writes to the file "stack" how many bytes of it were used, and to "ticks" how long each step took,
 * in ticks of SysTick: of the processor's 25 MHz clock, which QEMU with -icount shift=0 makes one for 40 instructions. */
#include <stdint.h>
#include "host.h"

#define PAINT 0xa5a5a5a5u
#define PAINTED 65536                      /* words */

enum { SYS_OPEN = 0x01, SYS_WRITE = 0x05, SYS_READ = 0x06, SYS_EXIT_EXTENDED = 0x20 };
enum { READ_BINARY = 1, WRITE_BINARY = 5 };
enum { APPLICATION_EXIT = 0x20026 };

extern uint32_t data_start[], data_end[], data_stored[], bss_start[], bss_end[], stack_top[];   /* cortex_m.ld */

int main(void);
void reset(void);

__attribute__((section(".vectors"), used)) static const void *const vectors[] = {stack_top, (const void *)reset};

static intptr_t input, output, ticks;
static uint32_t begun;

#define SYSTICK ((volatile uint32_t *)0xe000e010u)   /* control, reload, current: counts 24 bits down */

static intptr_t semihosting(intptr_t operation, const void *block)
{
    register intptr_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = block;

    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static intptr_t opened(const char *name, intptr_t length, intptr_t mode)
{
    const struct { const char *name; intptr_t mode, length; } block = {name, mode, length};

    return semihosting(SYS_OPEN, &block);
}

/* Returns how many bytes were not transferred. */
static intptr_t transfer(intptr_t operation, intptr_t file, const void *bytes, size_t size)
{
    const struct { intptr_t file; const void *bytes; size_t size; } block = {file, bytes, size};

    return semihosting(operation, &block);
}

int host_read(void *bytes, size_t size)
{
    return transfer(SYS_READ, input, bytes, size) == 0;
}

int host_write(const void *bytes, size_t size)
{
    return transfer(SYS_WRITE, output, bytes, size) == 0;
}

void host_begin(void)
{
    begun = SYSTICK[2];
}

void host_end(void)
{
    const uint32_t passed = (begun - SYSTICK[2]) & 0xffffffu;

    transfer(SYS_WRITE, ticks, &passed, sizeof passed);
}

static void initialise(void)
{
    const uint32_t *stored = data_stored;

    for (volatile uint32_t *word = data_start; word < data_end; ++word)
        *word = *stored++;
    for (volatile uint32_t *word = bss_start; word < bss_end; ++word)
        *word = 0;
}

static void paint(void)
{
    uint32_t *here = __builtin_frame_address(0);

    for (volatile uint32_t *word = stack_top - PAINTED; word < here - 64; ++word)
        *word = PAINT;
}

static uint32_t used(void)
{
    const volatile uint32_t *word = stack_top - PAINTED;

    while (*word == PAINT)
        ++word;
    return (uint32_t)((uintptr_t)stack_top - (uintptr_t)word);
}

void reset(void)
{
    *(volatile uint32_t *)0xe000ed88u |= 0xfu << 20;   /* CPACR: switch the floating-point unit on */
    __asm__ volatile("dsb\n isb");
    initialise();
    paint();
    input = opened("input", 5, READ_BINARY);
    output = opened("output", 6, WRITE_BINARY);
    ticks = opened("ticks", 5, WRITE_BINARY);
    SYSTICK[1] = 0xffffffu;
    SYSTICK[2] = 0;
    SYSTICK[0] = 5;                        /* on, at the processor's clock, without an interrupt */
    const intptr_t end[2] = {APPLICATION_EXIT, main()};
    const uint32_t stack = used();
    transfer(SYS_WRITE, opened("stack", 5, WRITE_BINARY), &stack, sizeof stack);
    semihosting(SYS_EXIT_EXTENDED, end);
    for (;;) {
    }
}
