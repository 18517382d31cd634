// SPDX-License-Identifier: MIT
#include "check.h"

#include "base/random.h"
#include "base/vector.h"
#include "occluder/rows.h"

enum { SIDE = 16, ROWS = SIDE + 2, POINTS = 200 };

static const double SLACK = 1e-4;

typedef struct Layers {
    pvtRows rows[ROWS];
    pvtRowSpan spans[ROWS][ROWS];
} Layers;

static double RollPlace(pvtRandom* random)
{
    // One in four on a face between voxels, or so close to it that it does not count.
    const double at = SIDE * pvtRandom_Unit(random);
    const double off = 0.4 * SLACK * (2.0 * pvtRandom_Unit(random) - 1.0);
    return pvtRandom_Below(random, 4) != 0 ? at : fmax(floor(at) + off, 0.0);
}

// Rolls a triangle, and cuts all of its layers.
static pvtRowCutter CutRandom(pvtRandom* random, pvtVec3 corners[3], Layers* layers)
{
    for (int k = 0; k < 3; ++k) {
        corners[k] = (pvtVec3){RollPlace(random), RollPlace(random), RollPlace(random)};
    }
    const pvtRowCutter cutter = pvtStartRows(corners, 1.0, SLACK);
    for (int z = cutter.firstLayer; z <= cutter.lastLayer; ++z) {
        layers->rows[z].spans = layers->spans[z];
        pvtCutLayer(&cutter, z, &layers->rows[z]);
    }
    return cutter;
}

static bool IsNearFace(double at)
{
    return fabs(at - floor(at + 0.5)) < 2.0 * SLACK;
}

static bool HasVoxel(const pvtRowCutter* cutter, const Layers* layers, const int voxel[3])
{
    const pvtRows* rows = &layers->rows[voxel[2]];
    if (voxel[2] < cutter->firstLayer || voxel[2] > cutter->lastLayer || voxel[1] < rows->first ||
        voxel[1] > rows->last) {
        return false;
    }
    int first, last;
    pvtRows_GetVoxels(rows, voxel[1], &first, &last);
    return voxel[0] >= first && voxel[0] <= last;
}

static void rows_have_each_voxel_that_a_triangle_passes(void** state)
{
    (void)state;
    pvtRandom random = pvtMakeRandom(5, 1);
    int tested = 0;
    for (int round = 0; round < 2000; ++round) {
        pvtVec3 corners[3];
        Layers layers;
        const pvtRowCutter cutter = CutRandom(&random, corners, &layers);
        for (int i = 0; i < POINTS; ++i) {
            const double u = pvtRandom_Unit(&random), v = (1.0 - u) * pvtRandom_Unit(&random);
            const pvtVec3 p = pvtAdd(pvtScale(corners[0], 1.0 - u - v),
                                     pvtAdd(pvtScale(corners[1], u), pvtScale(corners[2], v)));
            if (!IsNearFace(p.x) && !IsNearFace(p.y) && !IsNearFace(p.z)) {
                assert_true(HasVoxel(&cutter, &layers, (int[3]){(int)p.x, (int)p.y, (int)p.z}));
                ++tested;
            }
        }
    }
    assert_true(tested > 100000);
}

// Whether the triangle's plane comes within a voxel, and the boxes of both meet.
static bool MayPass(const pvtVec3 corners[3], const int voxel[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        const double a = pvtGetAxis(corners[0], axis), b = pvtGetAxis(corners[1], axis),
                     c = pvtGetAxis(corners[2], axis);
        if (fmax(a, fmax(b, c)) < voxel[axis] - SLACK ||
            fmin(a, fmin(b, c)) > voxel[axis] + 1 + SLACK) {
            return false;
        }
    }
    const pvtVec3 n =
        pvtNormalize(pvtCross(pvtSub(corners[1], corners[0]), pvtSub(corners[2], corners[0])));
    const pvtVec3 middle = {voxel[0] + 0.5, voxel[1] + 0.5, voxel[2] + 0.5};
    return fabs(pvtDot(n, pvtSub(middle, corners[0]))) <=
           0.5 * (fabs(n.x) + fabs(n.y) + fabs(n.z)) + SLACK;
}

static void rows_have_no_voxel_beside_a_triangle(void** state)
{
    (void)state;
    pvtRandom random = pvtMakeRandom(5, 2);
    for (int round = 0; round < 2000; ++round) {
        pvtVec3 corners[3];
        Layers layers;
        const pvtRowCutter cutter = CutRandom(&random, corners, &layers);
        for (int z = cutter.firstLayer; z <= cutter.lastLayer; ++z) {
            for (int y = layers.rows[z].first; y <= layers.rows[z].last; ++y) {
                int first, last;
                pvtRows_GetVoxels(&layers.rows[z], y, &first, &last);
                assert_true(MayPass(corners, (int[3]){first, y, z}));
                assert_true(MayPass(corners, (int[3]){last, y, z}));
            }
        }
    }
}

static void a_triangle_on_a_face_is_in_one_layer(void** state)
{
    (void)state;
    const pvtVec3 flat[3] = {{1.5, 1.5, 3.0}, {4.5, 1.5, 3.0}, {1.5, 4.5, 3.0}};
    const pvtRowCutter cutter = pvtStartRows(flat, 1.0, SLACK);
    assert_int_equal(cutter.firstLayer, 3);
    assert_int_equal(cutter.lastLayer, 3);
    pvtRowSpan spans[8];
    pvtRows rows = {.spans = spans};
    pvtCutLayer(&cutter, 3, &rows);
    assert_int_equal(rows.first, 1);
    assert_int_equal(rows.last, 4);
    static const int lasts[] = {4, 3, 2, 1};
    for (int y = 1; y <= 4; ++y) {
        int first, last;
        pvtRows_GetVoxels(&rows, y, &first, &last);
        assert_int_equal(first, 1);
        // Along the slanted edge a row's farthest point is at its lower side.
        assert_int_equal(last, lasts[y - 1]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_have_each_voxel_that_a_triangle_passes),
        cmocka_unit_test(rows_have_no_voxel_beside_a_triangle),
        cmocka_unit_test(a_triangle_on_a_face_is_in_one_layer),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
