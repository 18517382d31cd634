// SPDX-License-Identifier: MIT
// However a mesh is encoded, it is the same mesh: exactly where nothing is lost, within the
// encoding's own step where something is, and so is its occluder. With PVT_NASTY the same holds for
// the variants of one model that are known to be there.
#include "encodings.h"
#include "recipe_mesh.h"

#include <paravent/evaluate.h>
#include <paravent/occluder.h>

typedef struct Fixture {
    pvtContext* context;
    Warnings warnings;
    TestFolder folder;
} Fixture;

static int SetUp(void** state)
{
    Fixture* fixture = calloc(1, sizeof *fixture);
    assert_non_null(fixture);
    fixture->context = CreateWarningContext(&fixture->warnings);
    fixture->folder = MakeTestFolder();
    *state = fixture;
    return 0;
}

static int TearDown(void** state)
{
    Fixture* fixture = *state;
    (void)RemoveTestFolder(&fixture->folder);
    DestroyTestContext(fixture->context);
    free(fixture);
    return 0;
}

typedef struct Corner {
    double x, y, z;
} Corner;

static int CompareCorners(const void* left, const void* right)
{
    const Corner* a = left;
    const Corner* b = right;
    return a->x != b->x   ? (a->x < b->x ? -1 : 1)
           : a->y != b->y ? (a->y < b->y ? -1 : 1)
           : a->z != b->z ? (a->z < b->z ? -1 : 1)
                          : 0;
}

static int CompareTriangles(const void* left, const void* right)
{
    const Corner* a = left;
    const Corner* b = right;
    int order = 0;
    for (int k = 0; k < 3 && order == 0; ++k) {
        order = CompareCorners(&a[k], &b[k]);
    }
    return order;
}

// Triangles in an order that no file decides: each from its least corner on.
static Corner* SortTriangles(const pvtMesh* mesh)
{
    Corner(*triangles)[3] = calloc(mesh->triangleCount, sizeof *triangles);
    assert_non_null(triangles);
    for (size_t t = 0; t < mesh->triangleCount; ++t) {
        Corner corners[3];
        int least = 0;
        for (int k = 0; k < 3; ++k) {
            const pvtVec3 p = mesh->positions[mesh->indices[3 * t + (size_t)k]];
            corners[k] = (Corner){p.x + 0.0, p.y + 0.0, p.z + 0.0};
            least = CompareCorners(&corners[k], &corners[least]) < 0 ? k : least;
        }
        for (int k = 0; k < 3; ++k) {
            triangles[t][k] = corners[(least + k) % 3];
        }
    }
    qsort(triangles, mesh->triangleCount, sizeof *triangles, CompareTriangles);
    return &triangles[0][0];
}

static void CheckSameTriangles(const pvtMesh* a, const pvtMesh* b)
{
    assert_int_equal(a->triangleCount, b->triangleCount);
    Corner* left = SortTriangles(a);
    Corner* right = SortTriangles(b);
    for (size_t i = 0; i < 3 * a->triangleCount; ++i) {
        assert_int_equal(CompareCorners(&left[i], &right[i]), 0);
    }
    free(left);
    free(right);
}

// The farthest that a used position of `a` is from the nearest one of `b`, along any axis.
static double GetLargestMove(const pvtMesh* a, const pvtMesh* b)
{
    double largest = 0.0;
    for (size_t i = 0; i < 3 * a->triangleCount; ++i) {
        const pvtVec3 p = a->positions[a->indices[i]];
        double nearest = INFINITY;
        for (size_t j = 0; j < b->positionCount && nearest > largest; ++j) {
            const pvtVec3 q = b->positions[j];
            nearest = fmin(nearest, fmax(fabs(p.x - q.x), fmax(fabs(p.y - q.y), fabs(p.z - q.z))));
        }
        largest = fmax(largest, nearest);
    }
    return largest;
}

static pvtOccluder BuildOccluder(pvtContext* context, const pvtMesh* mesh)
{
    pvtBuildOptions options = pvtDefaultBuildOptions();
    options.resolution = 24;
    options.budget = 8;
    options.effort = PVT_EFFORT_FAST;
    options.views.count = 4;
    pvtOccluder occluder;
    CHECK_OK(context, pvtBuildOccluder(context, &options, mesh, &occluder, NULL));
    return occluder;
}

static void CheckSameOccluder(const pvtOccluder* a, const pvtOccluder* b)
{
    assert_int_equal(a->mesh.positionCount, b->mesh.positionCount);
    assert_int_equal(a->mesh.triangleCount, b->mesh.triangleCount);
    assert_memory_equal(a->mesh.positions, b->mesh.positions,
                        a->mesh.positionCount * sizeof *a->mesh.positions);
    assert_memory_equal(a->mesh.indices, b->mesh.indices,
                        3 * a->mesh.triangleCount * sizeof *a->mesh.indices);
}

// The occluder lies inside of what was read. So over the original it reaches by no more than what
// was lost, and by half a pixel, since that is how silhouettes are measured; and it is as good.
static void CheckWithinLoss(pvtContext* context, const pvtMesh* plain, const pvtOccluder* best,
                            const pvtOccluder* other, double loss)
{
    pvtEvaluateOptions options = pvtDefaultEvaluateOptions();
    options.views = 16;
    options.quads = 2000;
    options.pixels = 256;
    const pvtMesh occluders[2] = {best->mesh, other->mesh};
    pvtEvaluation evaluation;
    CHECK_OK(context, pvtEvaluateOccluders(context, &options, plain, occluders, 2, &evaluation));
    const pvtOccluderScore* scores = evaluation.occluders;
    const pvtBox3 box = pvtMesh_GetBounds(plain);
    const double dx = box.upper.x - box.lower.x, dy = box.upper.y - box.lower.y,
                 dz = box.upper.z - box.lower.z;
    const double pixel = sqrt(dx * dx + dy * dy + dz * dz) / options.pixels;
    CHECK_NEAR(scores[0].overThickness, 0.0, 0.0);
    CHECK_NEAR(scores[1].overThickness, 0.0, loss > 0.5 * pixel ? loss + pixel : 0.0);
    // With so few triangles a climb from a little elsewhere may end elsewhere.
    CHECK_NEAR(scores[1].uniform.recall, scores[0].uniform.recall, 0.15);
    pvtEvaluation_Free(context, &evaluation);
}

static void CheckMesh(const pvtMesh* plain, const pvtMesh* mesh, double loss)
{
    if (loss == 0.0) {
        CheckSameTriangles(plain, mesh);
    } else {
        assert_int_equal(plain->triangleCount, mesh->triangleCount);
        // What floats and doubles round on the way.
        const pvtBox3 box = pvtMesh_GetBounds(plain);
        const double rounding = 1e-6 * (fabs(box.lower.x) + fabs(box.upper.x) + fabs(box.lower.y) +
                                        fabs(box.upper.y) + fabs(box.lower.z) + fabs(box.upper.z));
        CHECK_NEAR(GetLargestMove(plain, mesh), 0.0, loss + rounding);
        CHECK_NEAR(GetLargestMove(mesh, plain), 0.0, loss + rounding);
    }
}

// `expected` is the plain mesh's occluder; null: only the mesh is looked at.
static void CheckVariant(Fixture* f, const pvtMesh* plain, const pvtOccluder* expected,
                         const char* path, double loss)
{
    pvtModel model;
    CHECK_OK(f->context, pvtLoadModel(f->context, NULL, path, &model));
    CheckMesh(plain, &model.mesh, loss);
    if (expected != NULL) {
        pvtOccluder occluder = BuildOccluder(f->context, &model.mesh);
        if (loss == 0.0) {
            CheckSameOccluder(expected, &occluder);
        } else {
            CheckWithinLoss(f->context, plain, expected, &occluder, loss);
        }
        pvtOccluder_Free(f->context, &occluder);
    }
    pvtModel_Free(f->context, &model);
}

static void CheckRecipe(Fixture* f, const char* name, bool withOccluder)
{
    pvtMesh mesh;
    CHECK_OK(f->context, MakeRecipeMesh(f->context, name, &mesh));
    Plain plain = MakePlain(&mesh);
    pvtMesh_Free(f->context, &mesh);
    pvtModel model;
    const char* path = InFolder(&f->folder, "plain.glb");
    assert_true(GetEncoding(0)->write(&plain, path) == 0.0);
    CHECK_OK(f->context, pvtLoadModel(f->context, NULL, path, &model));
    assert_int_equal(model.mesh.triangleCount, plain.triangleCount);
    pvtOccluder expected = {0};
    if (withOccluder) {
        expected = BuildOccluder(f->context, &model.mesh);
    }
    for (size_t i = 1; GetEncoding(i) != NULL; ++i) {
        print_message("%s: %s\n", name, GetEncoding(i)->name);
        const char* variant = InFolder(&f->folder, "variant.glb");
        const double loss = GetEncoding(i)->write(&plain, variant);
        CheckVariant(f, &model.mesh, withOccluder ? &expected : NULL, variant, loss);
        assert_null(strstr(f->warnings.text, "left out"));
    }
    pvtOccluder_Free(f->context, &expected);
    pvtModel_Free(f->context, &model);
    Plain_Free(&plain);
}

static void every_encoding_of_a_boulder_gives_its_occluder(void** state)
{
    CheckRecipe(*state, "boulder", true);
}

static void every_encoding_of_a_torus_gives_its_triangles(void** state)
{
    CheckRecipe(*state, "torus", false);
}

static void variants_of_known_models_give_the_plain_files_occluder(void** state)
{
    Fixture* f = *state;
    const char* folder = getenv("PVT_NASTY");
    if (folder == NULL || folder[0] == '\0') {
        skip();
    }
    // The loss: Draco stored the first boxes' corners exactly; the others say their step.
    static const struct {
        const char* plain;
        const char* variant;
        double loss;
    } pairs[] = {
        {"khronos-samples/Box_glTF-Embedded/Box.gltf", "khronos-samples/Box_glTF-Draco/Box.gltf",
         0},
        {"khronos-samples/Box_glTF-Embedded/Box.gltf", "compressed/BoxDraco.gltf", 0},
        {"khronos-samples/Box_glTF-Embedded/Box.gltf", "compressed/BoxMeshopt.gltf", 0},
        {"khronos-samples/Box_glTF-Embedded/Box.gltf", "compressed/BoxMeshopt.glb", 0.5 / 16383},
        {"khronos-samples/AnimatedMorphCube_glTF-Binary/AnimatedMorphCube.glb",
         "khronos-samples/AnimatedMorphCube_glTF-Quantized/AnimatedMorphCube.gltf", 0.5 / 5481 * 2},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; ++i) {
        char path[4096];
        pvtModel plain;
        (void)snprintf(path, sizeof path, "%s/%s", folder, pairs[i].plain);
        CHECK_OK(f->context, pvtLoadModel(f->context, NULL, path, &plain));
        (void)snprintf(path, sizeof path, "%s/%s", folder, pairs[i].variant);
        print_message("%s\n", pairs[i].variant);
        pvtOccluder expected = BuildOccluder(f->context, &plain.mesh);
        CheckVariant(f, &plain.mesh, &expected, path, pairs[i].loss);
        pvtOccluder_Free(f->context, &expected);
        pvtModel_Free(f->context, &plain);
    }
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, SetUp, TearDown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(every_encoding_of_a_boulder_gives_its_occluder),
        TEST(every_encoding_of_a_torus_gives_its_triangles),
        TEST(variants_of_known_models_give_the_plain_files_occluder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
