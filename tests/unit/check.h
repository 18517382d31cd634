// SPDX-License-Identifier: MIT
// What every unit test includes: cmocka in the order that it wants, and a context.
#ifndef PVT_TEST_CHECK_H
#define PVT_TEST_CHECK_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <paravent/base.h>
#include <stdio.h>
#include <time.h>

/// [s] What the process has worked so far, on all threads together: what a test may hold against a
/// bound, however busy the machine is with other things.
static inline double GetCpuSeconds(void)
{
    struct timespec now;
    assert_int_equal(clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now), 0);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/// Fails with the context's message when `call` is not PVT_OK.
#define CHECK_OK(context, call)                                                                    \
    do {                                                                                           \
        if ((call) != PVT_OK) {                                                                    \
            fail_msg("%s: %s", #call, pvtContext_GetMessage(context));                             \
        }                                                                                          \
    } while (0)

/// Fails when two numbers differ by more than `most`; also when one is not a number.
#define CHECK_NEAR(measured, expected, most)                                                       \
    do {                                                                                           \
        const double measured_ = (measured);                                                       \
        const double expected_ = (expected);                                                       \
        if (!(fabs(measured_ - expected_) <= (most))) {                                            \
            fail_msg("%s is %.17g, not %.17g", #measured, measured_, expected_);                   \
        }                                                                                          \
    } while (0)

static inline pvtContext* CreateTestContext(int threadCount)
{
    pvtContextDef def = pvtDefaultContextDef();
    def.threadCount = threadCount;
    pvtContext* context = NULL;
    assert_int_equal(pvtCreateContext(&def, &context), PVT_OK);
    return context;
}

/// Also fails when something is still held.
static inline void DestroyTestContext(pvtContext* context)
{
    assert_int_equal(pvtContext_GetHeldBytes(context), 0);
    pvtDestroyContext(context);
}

#endif
