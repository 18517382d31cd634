// SPDX-License-Identifier: MIT
#include "voxel_shapes.h"

#include <math.h>
#include <paravent/section.h>
#include <string.h>

// What a search looks into, and where.
typedef struct Field {
    pvtBitGrid grid;
    pvtSliceVolume volume;
    pvtSectionPlan plan;
} Field;

// For a grid that is made and filled already.
static void PlanField(pvtContext* context, Field* field)
{
    CHECK_OK(context, pvtCreateSliceVolume(context, &field->grid, &field->volume));
    pvtFaceDirection face = {{sqrt(0.5), sqrt(0.5), 0.0}, 1.0};
    const pvtFaceDirectionSet faces = {&face, 1};
    pvtPlanOptions options = pvtDefaultPlanOptions();
    options.faces = &faces;
    options.directions = 12;
    options.depths = 9;
    CHECK_OK(context, pvtPlanSections(context, &options, &field->grid, &field->plan));
}

// A shape with thick and thin parts, apart from each other.
static void MakeLumps(pvtContext* context, Field* field)
{
    pvtBitGrid* grid = &field->grid;
    MakeShiftedGrid(context, 70, 40, 50, grid);
    SetBox(grid, (int[]){3, 4, 5}, (int[]){30, 30, 9});
    SetBox(grid, (int[]){10, 14, 3}, (int[]){13, 38, 44});
    SetBox(grid, (int[]){48, 5, 10}, (int[]){66, 25, 47});
    SetBox(grid, (int[]){20, 33, 20}, (int[]){32, 34, 40});
    PlanField(context, field);
}

static void FreeField(pvtContext* context, Field* field)
{
    pvtSectionPlan_Free(context, &field->plan);
    pvtSliceVolume_Free(context, &field->volume);
    pvtBitGrid_Free(context, &field->grid);
}

static double MeasurePlane(pvtContext* context, const pvtSliceVolume* volume, const pvtPlane* plane,
                           pvtSliceRule rule, int cells)
{
    const int* size = volume->grid->frame.size;
    pvtBitmap slice;
    CHECK_OK(context, pvtCreateBitmap(context, size[pvtPlane_GetU(plane)] * cells,
                                      size[pvtPlane_GetV(plane)] * cells, &slice));
    pvtSliceGrid(volume, plane, rule, cells, &slice);
    const double area = pvtMeasureSlice(&slice, plane, cells);
    pvtBitmap_Free(context, &slice);
    return area;
}

// Slices every plane of a bin by the rule itself; true when some area is not 0.
static bool FindLargest(pvtContext* context, const Field* field, size_t bin, pvtSliceRule rule,
                        pvtSection* largest)
{
    const pvtSectionPlan* plan = &field->plan;
    largest->area = 0.0;
    for (size_t i = plan->binStarts[bin]; i < plan->binStarts[bin + 1]; ++i) {
        const double area = MeasurePlane(context, &field->volume, &plan->planes[i], rule, 1);
        if (area > largest->area) {
            *largest = (pvtSection){plan->planes[i], area};
        }
    }
    return largest->area > 0.0;
}

static bool IsSamePlane(const pvtPlane* a, const pvtPlane* b)
{
    return a->axis == b->axis && a->slopeU == b->slopeU && a->slopeV == b->slopeV &&
           a->offset == b->offset;
}

static void each_bin_gives_its_first_largest_slice_or_none(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(2);
    Field field;
    MakeLumps(context, &field);
    for (int rule = 0; rule < 2; ++rule) {
        pvtSearchOptions options = pvtDefaultSearchOptions();
        options.rule = (pvtSliceRule)rule;
        pvtSectionSet set;
        CHECK_OK(context, pvtSearchSections(context, &options, &field.volume, &field.plan, &set));
        size_t next = 0;
        for (size_t bin = 0; bin < field.plan.binCount; ++bin) {
            pvtSection largest;
            if (FindLargest(context, &field, bin, options.rule, &largest)) {
                assert_true(next < set.count);
                assert_true(IsSamePlane(&set.sections[next].plane, &largest.plane));
                assert_true(set.sections[next].area == largest.area);
                ++next;
            }
        }
        assert_true(next == set.count && set.count > 100);
        assert_true(rule == PVT_SLICE_CENTER || set.count < field.plan.binCount);
        pvtSectionSet_Free(context, &set);
    }
    FreeField(context, &field);
    DestroyTestContext(context);
}

static void areas_are_those_of_the_rule_and_cells_asked_for(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    Field field;
    MakeLumps(context, &field);
    for (int n = 0; n < 4; ++n) {
        pvtSearchOptions options = pvtDefaultSearchOptions();
        options.rule = (pvtSliceRule)(n % 2);
        options.cellsPerVoxel = n < 2 ? 2 : 4;
        pvtSectionSet set;
        CHECK_OK(context, pvtSearchSections(context, &options, &field.volume, &field.plan, &set));
        assert_int_equal(set.rule, options.rule);
        assert_int_equal(set.cellsPerVoxel, options.cellsPerVoxel);
        assert_true(set.count > 100);
        for (size_t i = 0; i < set.count; i += 5) {
            const double area = MeasurePlane(context, &field.volume, &set.sections[i].plane,
                                             options.rule, options.cellsPerVoxel);
            assert_true(set.sections[i].area == area);
        }
        pvtSectionSet_Free(context, &set);
    }
    FreeField(context, &field);
    DestroyTestContext(context);
}

static void the_faces_of_a_box_are_found_in_full_at_both_ends(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    Field field;
    MakeShiftedGrid(context, 50, 60, 70, &field.grid);
    const int lower[3] = {5, 7, 9}, upper[3] = {41, 52, 66};
    SetBox(&field.grid, lower, upper);
    PlanField(context, &field);
    const pvtSearchOptions options = pvtDefaultSearchOptions();
    pvtSectionSet set;
    CHECK_OK(context, pvtSearchSections(context, &options, &field.volume, &field.plan, &set));
    for (int axis = 0; axis < 3; ++axis) {
        const int u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
        const double face = (double)(upper[u] - lower[u]) * (upper[v] - lower[v]);
        int ends = 0;
        for (size_t i = 0; i < set.count; ++i) {
            const pvtPlane* plane = &set.sections[i].plane;
            if ((int)plane->axis == axis && plane->slopeU == 0 && plane->slopeV == 0) {
                assert_true(set.sections[i].area == face);
                const int64_t layer = plane->offset >> PVT_PLANE_BITS;
                ends |= layer == lower[axis] ? 1 : layer == upper[axis] - 1 ? 2 : 0;
            }
        }
        assert_int_equal(ends, 3);
    }
    pvtSectionSet_Free(context, &set);
    FreeField(context, &field);
    DestroyTestContext(context);
}

// The voxels whose cubes lie within x + y ≤ 60 wholly: a 45° roof in steps.
static void a_slanted_face_is_found_in_full_just_below_its_steps(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    Field field;
    MakeShiftedGrid(context, 64, 64, 64, &field.grid);
    for (int y = 2; y < 58; ++y) {
        SetBox(&field.grid, (int[]){2, y, 2}, (int[]){60 - y > 2 ? 60 - y - 1 : 2, y + 1, 62});
    }
    PlanField(context, &field);
    const pvtSearchOptions options = pvtDefaultSearchOptions();
    pvtSectionSet set;
    CHECK_OK(context, pvtSearchSections(context, &options, &field.volume, &field.plan, &set));
    double largest = 0.0;
    for (size_t i = 0; i < set.count; ++i) {
        largest = fmax(largest, set.sections[i].area);
    }
    // The face itself is 56 × √2 wide and 60 long.
    assert_true(largest > 0.95 * 56.0 * sqrt(2.0) * 60.0);
    assert_true(largest <= 56.0 * sqrt(2.0) * 60.0);
    pvtSectionSet_Free(context, &set);
    FreeField(context, &field);
    DestroyTestContext(context);
}

typedef struct TestSlicer {
    const pvtSliceVolume* volume;
    int left; // slices until it fails
} TestSlicer;

static pvtStatus SliceElsewhere(pvtContext* context, void* user, const pvtPlane* plane,
                                int cellsPerVoxel, pvtBitmap* slice)
{
    TestSlicer* slicer = user;
    if (slicer->left-- == 0) {
        return pvtFail(context, PVT_UNSUPPORTED, "the slicer broke");
    }
    pvtSliceGrid(slicer->volume, plane, PVT_SLICE_CENTER, cellsPerVoxel, slice);
    return PVT_OK;
}

static void sections_are_the_same_for_any_number_of_threads_and_any_slicer(void** state)
{
    (void)state;
    pvtContext* contexts[] = {CreateTestContext(1), CreateTestContext(4)};
    Field field;
    MakeLumps(contexts[0], &field);
    TestSlicer user = {&field.volume, -1};
    const pvtSlicer slicer = {SliceElsewhere, &user};
    pvtSectionSet sets[3];
    for (int n = 0; n < 3; ++n) {
        pvtSearchOptions options = pvtDefaultSearchOptions();
        options.slicer = n == 2 ? &slicer : NULL;
        pvtContext* context = contexts[n == 0 ? 0 : 1];
        CHECK_OK(context,
                 pvtSearchSections(context, &options, &field.volume, &field.plan, &sets[n]));
        assert_true(sets[n].count == sets[0].count);
        for (size_t i = 0; i < sets[n].count; ++i) {
            assert_true(IsSamePlane(&sets[n].sections[i].plane, &sets[0].sections[i].plane));
            assert_true(sets[n].sections[i].area == sets[0].sections[i].area);
        }
    }
    assert_int_equal(user.left, -1 - (int)field.plan.planeCount);
    for (int n = 0; n < 3; ++n) {
        pvtSectionSet_Free(contexts[n == 0 ? 0 : 1], &sets[n]);
    }
    FreeField(contexts[0], &field);
    DestroyTestContext(contexts[0]);
    DestroyTestContext(contexts[1]);
}

static void a_slicer_that_fails_ends_the_search(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    Field field;
    MakeLumps(context, &field);
    TestSlicer user = {&field.volume, 7};
    const pvtSlicer slicer = {SliceElsewhere, &user};
    pvtSearchOptions options = pvtDefaultSearchOptions();
    options.slicer = &slicer;
    pvtSectionSet set;
    assert_int_equal(pvtSearchSections(context, &options, &field.volume, &field.plan, &set),
                     PVT_UNSUPPORTED);
    assert_non_null(strstr(pvtContext_GetMessage(context), "the slicer broke"));
    assert_true(set.sections == NULL && set.count == 0 && user.left == -1);
    options = pvtDefaultSearchOptions();
    options.cellsPerVoxel = 3;
    assert_int_equal(pvtSearchSections(context, &options, &field.volume, &field.plan, &set),
                     PVT_INVALID_ARGUMENT);
    FreeField(context, &field);
    DestroyTestContext(context);
}

static void an_empty_plan_gives_an_empty_set(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    Field field;
    MakeShiftedGrid(context, 20, 20, 20, &field.grid);
    PlanField(context, &field);
    const pvtSearchOptions options = pvtDefaultSearchOptions();
    pvtSectionSet set;
    CHECK_OK(context, pvtSearchSections(context, &options, &field.volume, &field.plan, &set));
    assert_true(set.count == 0);
    pvtSectionSet_Free(context, &set);
    FreeField(context, &field);
    DestroyTestContext(context);
}

// What a context is told to stop after, what it has for memory, and what it reported.
typedef struct Hooks {
    CancelCounter counter;
    PoorHeap heap;
    double reported;
} Hooks;

static bool IsSearchCancelled(void* user)
{
    return IsCancelledAfter(&((Hooks*)user)->counter);
}

static void NoteProgress(const char* stage, double fraction, void* user)
{
    (void)stage;
    Hooks* hooks = user;
    assert_true(fraction >= hooks->reported && fraction <= 1.0);
    hooks->reported = fraction;
}

static pvtStatus SearchWithHooks(Hooks* hooks, const Field* field)
{
    pvtContextDef def = pvtDefaultContextDef();
    def.threadCount = 2;
    def.allocator = (pvtAllocator){AllocateFromPoorHeap, ReleaseToPoorHeap, &hooks->heap};
    def.isCancelled = IsSearchCancelled;
    def.progress = NoteProgress;
    def.user = hooks;
    pvtContext* context = NULL;
    assert_int_equal(pvtCreateContext(&def, &context), PVT_OK);
    const pvtSearchOptions options = pvtDefaultSearchOptions();
    pvtSectionSet set;
    const pvtStatus status =
        pvtSearchSections(context, &options, &field->volume, &field->plan, &set);
    assert_true((status == PVT_OK) == (set.sections != NULL));
    pvtSectionSet_Free(context, &set);
    DestroyTestContext(context);
    return status;
}

static void a_search_can_be_cancelled_anywhere_and_fails_cleanly_without_memory(void** state)
{
    (void)state;
    pvtContext* context = CreateTestContext(1);
    Field field;
    MakeLumps(context, &field);
    const int all = (int)(field.plan.planeCount + field.plan.binCount);
    for (int questions = 0; questions < all; questions += all / 20) {
        Hooks hooks = {.counter = {questions}, .heap.failAt = 1000};
        assert_int_equal(SearchWithHooks(&hooks, &field), PVT_CANCELLED);
    }
    for (int blocks = 1; blocks < 5; ++blocks) {
        Hooks hooks = {.counter = {all + 1}, .heap.failAt = blocks};
        assert_int_equal(SearchWithHooks(&hooks, &field), PVT_OUT_OF_MEMORY);
    }
    Hooks hooks = {.counter = {all + 1}, .heap.failAt = 5};
    assert_int_equal(SearchWithHooks(&hooks, &field), PVT_OK);
    assert_true(hooks.reported > 0.1);
    FreeField(context, &field);
    DestroyTestContext(context);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_bin_gives_its_first_largest_slice_or_none),
        cmocka_unit_test(areas_are_those_of_the_rule_and_cells_asked_for),
        cmocka_unit_test(the_faces_of_a_box_are_found_in_full_at_both_ends),
        cmocka_unit_test(a_slanted_face_is_found_in_full_just_below_its_steps),
        cmocka_unit_test(sections_are_the_same_for_any_number_of_threads_and_any_slicer),
        cmocka_unit_test(a_slicer_that_fails_ends_the_search),
        cmocka_unit_test(an_empty_plan_gives_an_empty_set),
        cmocka_unit_test(a_search_can_be_cancelled_anywhere_and_fails_cleanly_without_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
