// SPDX-License-Identifier: MIT
#include "check.h"

#include "base/bits.h"
#include "base/context.h"

#include <paravent/image.h>
#include <paravent/output.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void every_index_runs_once(size_t begin, size_t end, int worker, void* data)
{
    (void)worker;
    atomic_int* counts = data;
    for (size_t i = begin; i < end; ++i) {
        atomic_fetch_add(&counts[i], 1);
    }
}

static void parallel_for_runs_every_index_once(void** state)
{
    (void)state;
    static atomic_int counts[10007];
    pvtContext* context = CreateTestContext(4);
    for (int round = 0; round < 50; ++round) {
        memset(counts, 0, sizeof counts);
        const size_t count = round == 0 ? 0 : (size_t)(round * 200);
        pvtParallelFor(context, every_index_runs_once, count, 7, counts);
        for (size_t i = 0; i < 10007; ++i) {
            assert_int_equal(atomic_load(&counts[i]), i < count ? 1 : 0);
        }
    }
    DestroyTestContext(context);
}

static void a_request_over_the_limit_is_refused_before_it_is_tried(void** state)
{
    (void)state;
    pvtContextDef def = pvtDefaultContextDef();
    def.memoryLimit = 1 << 20;
    pvtContext* context = NULL;
    assert_int_equal(pvtCreateContext(&def, &context), PVT_OK);
    void* kept = pvtAllocate(context, 1000, 1000);
    assert_non_null(kept);
    assert_null(pvtAllocate(context, 1000, 1000));
    assert_int_equal(pvtContext_GetStatus(context), PVT_LIMIT);
    assert_non_null(strstr(pvtContext_GetMessage(context), "memory limit"));
    assert_null(pvtAllocate(context, SIZE_MAX / 2, 3));
    pvtRelease(context, kept);
    assert_int_equal(pvtContext_GetHeldBytes(context), 0);
    assert_true(pvtContext_GetPeakBytes(context) >= 1000000);
    pvtDestroyContext(context);
}

static void blocks_are_zeroed_aligned_and_keep_their_bytes_when_grown(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    uint8_t* block = pvtAllocate(context, 100, 1);
    assert_int_equal((uintptr_t)block % 64, 0);
    memset(block, 7, 100);
    block = pvtReallocate(context, block, 300, 1);
    for (int i = 0; i < 300; ++i) {
        assert_int_equal(block[i], i < 100 ? 7 : 0);
    }
    // The old block is gone in pvtReallocate, so that only one is held.
    pvtRelease(context, block);
    DestroyTestContext(context);
}

static void bit_ranges_agree_with_single_bits(void** state)
{
    (void)state;
    for (size_t begin = 0; begin < 200; begin += 3) {
        for (size_t end = begin; end < 200; end += 5) {
            uint64_t row[4] = {0};
            pvtSetBitRange(row, begin, end);
            for (size_t bit = 0; bit < 256; ++bit) {
                assert_int_equal(pvtGetBit(row, bit), bit >= begin && bit < end);
            }
            assert_true(pvtIsBitRangeSet(row, begin, end));
            assert_false(pvtIsBitRangeSet(row, begin, end + 1));
        }
    }
}

static void an_output_appears_whole_or_not_at_all(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    char folder[] = "/tmp/pvt-test-XXXXXX";
    assert_non_null(mkdtemp(folder));
    char path[256];
    (void)snprintf(path, sizeof path, "%s/out.txt", folder);
    pvtOutput* output = NULL;
    CHECK_OK(context, pvtOpenOutput(context, path, &output));
    pvtOutput_Print(output, "%d bottles", 99);
    assert_int_not_equal(access(path, F_OK), 0);
    CHECK_OK(context, pvtCommitOutput(output));
    assert_int_equal(access(path, F_OK), 0);

    CHECK_OK(context, pvtOpenOutput(context, path, &output));
    pvtOutput_Print(output, "nothing");
    pvtDiscardOutput(output);
    char text[32] = {0};
    FILE* file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fread(text, 1, sizeof text - 1, file), 10);
    fclose(file);
    assert_string_equal(text, "99 bottles");
    unlink(path);
    assert_int_equal(rmdir(folder), 0); // no temporary file is left in it
    assert_int_equal(pvtOpenOutput(context, "/nonexistent/x", &output), PVT_OUTPUT_FAILED);
    assert_null(output);
    assert_non_null(strstr(pvtContext_GetMessage(context), "/nonexistent/x"));
    DestroyTestContext(context);
}

static void a_full_disk_is_told(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    pvtOutput* output = NULL;
    CHECK_OK(context, pvtOpenOutput(context, "/dev/full", &output));
    for (int i = 0; i < 10000; ++i) {
        pvtOutput_Print(output, "a line that will not fit\n");
    }
    assert_int_equal(pvtCommitOutput(output), PVT_OUTPUT_FAILED);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parallel_for_runs_every_index_once),
        cmocka_unit_test(a_request_over_the_limit_is_refused_before_it_is_tried),
        cmocka_unit_test(blocks_are_zeroed_aligned_and_keep_their_bytes_when_grown),
        cmocka_unit_test(bit_ranges_agree_with_single_bits),
        cmocka_unit_test(an_output_appears_whole_or_not_at_all),
        cmocka_unit_test(a_full_disk_is_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
