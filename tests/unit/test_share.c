// SPDX-License-Identifier: MIT
// A shared budget: never exceeded, nobody forgotten, more for those who hide more.
#include "failures.h"

#include <paravent/separate.h>

static size_t CountDrawn(const pvtClaim* claims, const int* shares, size_t count)
{
    size_t drawn = 0;
    for (size_t i = 0; i < count; ++i) {
        drawn += claims[i].instanceCount * (size_t)shares[i];
    }
    return drawn;
}

static void Share(const pvtClaim* claims, size_t count, int budget, int* shares)
{
    pvtContext* context = CreateTestContext(1);
    CHECK_OK(context, pvtShareBudget(context, claims, count, budget, shares));
    assert_true(CountDrawn(claims, shares, count) <= (size_t)budget);
    DestroyTestContext(context);
}

static void one_claim_gets_everything(void** state)
{
    (void)state;
    int share = -1;
    Share(&(pvtClaim){3.0, 1}, 1, 53, &share);
    assert_int_equal(share, 53);
    Share(&(pvtClaim){3.0, 7}, 1, 53, &share);
    assert_int_equal(share, 7);
    Share(&(pvtClaim){1e-300, 1}, 1, 65535, &share);
    assert_int_equal(share, 65535);
    Share(&(pvtClaim){1.0, 1}, 1, 1, &share);
    assert_int_equal(share, 1);
    Share(&(pvtClaim){0.0, 1}, 1, 64, &share);
    assert_int_equal(share, 0);
}

static void equal_claims_get_equal_shares_and_all_is_given(void** state)
{
    (void)state;
    enum { COUNT = 9 };
    pvtClaim claims[COUNT];
    int shares[COUNT];
    for (int i = 0; i < COUNT; ++i) {
        claims[i] = (pvtClaim){2.5, 1};
    }
    for (int budget = 2 * COUNT; budget < 200; ++budget) {
        Share(claims, COUNT, budget, shares);
        assert_int_equal(CountDrawn(claims, shares, COUNT), budget);
        for (int i = 0; i < COUNT; ++i) {
            assert_in_range(shares[i], budget / COUNT, budget / COUNT + 1);
        }
    }
}

// t + 8 is proportional to the root of the claim, as long as nobody is at the least.
static void shares_grow_with_the_root_of_the_claim(void** state)
{
    (void)state;
    const pvtClaim claims[] = {{1.0, 1}, {4.0, 1}, {16.0, 1}};
    int shares[3];
    Share(claims, 3, 1000, shares);
    assert_int_equal(CountDrawn(claims, shares, 3), 1000);
    for (int i = 0; i < 3; ++i) {
        CHECK_NEAR(shares[i] + 8.0, 1024.0 / 7.0 * (1 << i), 1.0);
    }
}

static void instances_are_paid_for_and_hollow_meshes_get_nothing(void** state)
{
    (void)state;
    // The second is drawn a hundred times; each of them hides as much as the first.
    const pvtClaim claims[] = {{1.0, 1}, {1.0, 100}, {0.0, 3}};
    int shares[3];
    Share(claims, 3, 2020, shares);
    assert_int_equal(shares[0], shares[1]);
    assert_int_equal(shares[0], 20);
    assert_int_equal(shares[2], 0);
}

static void a_small_budget_goes_to_the_largest_that_fit(void** state)
{
    (void)state;
    const pvtClaim claims[] = {{1.0, 2}, {9.0, 40}, {5.0, 3}, {0.5, 1}};
    int shares[4];
    Share(claims, 4, 11, shares);
    assert_int_equal(shares[1], 0); // 40 instances do not fit
    assert_int_equal(shares[2], 2);
    assert_int_equal(shares[0], 2);
    assert_int_equal(shares[3], 1); // what is left
    Share(claims, 4, 92, shares);
    for (int i = 0; i < 4; ++i) {
        assert_int_equal(shares[i], 2);
    }
}

// A larger claim never has the smaller share, whatever the numbers of instances.
static void nobody_who_hides_more_gets_less(void** state)
{
    (void)state;
    enum { COUNT = 40 };
    pvtClaim claims[COUNT];
    int shares[COUNT];
    uint64_t seed = 12345;
    for (int i = 0; i < COUNT; ++i) {
        seed = seed * UINT64_C(6364136223846793005) + 1442695040888963407;
        claims[i] = (pvtClaim){ldexp((double)(seed >> 40), -(int)(seed >> 33 & 31)),
                               1 + (size_t)(seed >> 50 & 15)};
    }
    Share(claims, COUNT, 5000, shares);
    for (int i = 0; i < COUNT; ++i) {
        assert_true(shares[i] >= 2);
        for (int j = 0; j < COUNT; ++j) {
            // What is left at the end is given one by one, to whom it fits.
            assert_true(!(claims[i].possible > claims[j].possible) || shares[i] + 1 >= shares[j]);
        }
    }
}

static pvtStatus ShareSome(pvtContext* context, const void* input)
{
    (void)input;
    const pvtClaim claims[] = {{1.0, 2}, {9.0, 4}};
    int shares[2];
    return pvtShareBudget(context, claims, 2, 64, shares);
}

static void failing_allocations_are_told(void** state)
{
    (void)state;
    CheckEveryAllocation(ShareSome, NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_claim_gets_everything),
        cmocka_unit_test(equal_claims_get_equal_shares_and_all_is_given),
        cmocka_unit_test(shares_grow_with_the_root_of_the_claim),
        cmocka_unit_test(instances_are_paid_for_and_hollow_meshes_get_nothing),
        cmocka_unit_test(a_small_budget_goes_to_the_largest_that_fit),
        cmocka_unit_test(nobody_who_hides_more_gets_less),
        cmocka_unit_test(failing_allocations_are_told),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
