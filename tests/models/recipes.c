// SPDX-License-Identifier: MIT
// The project's own models. Each stands for a kind of asset that an occluder generator has to cope
// with; models/README.md says which.
#include "recipes.h"

#include "masked_recipes.h"

#include "base/random.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

static Point Add(Point a, Point b)
{
    return (Point){a.x + b.x, a.y + b.y, a.z + b.z};
}

static Point Scale(Point a, double s)
{
    return (Point){a.x * s, a.y * s, a.z * s};
}

static Point Cross(Point a, Point b)
{
    return (Point){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static Point Normalize(Point a)
{
    return Scale(a, 1.0 / sqrt(a.x * a.x + a.y * a.y + a.z * a.z));
}

// A closed solid: a sphere of latitudes and longitudes, dented by a few waves, 3 m across.
static void MakeBoulder(Model* model)
{
    enum { RINGS = 18, SIDES = 28 };
    Shape* shape = AddShape(model, "boulder", (Point){0, 0, 0});
    for (int ring = 0; ring <= RINGS; ++ring) {
        const int sides = ring == 0 || ring == RINGS ? 1 : SIDES;
        for (int side = 0; side < sides; ++side) {
            const double v = PI * ring / RINGS;
            const double u = 2.0 * PI * side / SIDES;
            const Point n = {sin(v) * cos(u), -cos(v), sin(v) * sin(u)};
            const double dent = 0.18 * sin(2.3 * n.x + 1.1) * sin(3.1 * n.z + 0.4) +
                                0.12 * sin(4.7 * n.y + 2.0 * n.x) +
                                0.05 * sin(9.0 * n.z - 5.0 * n.x);
            const double radius = 1.5 * (1.0 + dent);
            AddPoint(shape, (Point){1.15 * radius * n.x, 0.8 * radius * n.y, radius * n.z});
        }
    }
    const uint32_t last = shape->pointCount - 1;
    for (uint32_t side = 0; side < SIDES; ++side) {
        const uint32_t next = (side + 1) % SIDES;
        AddTriangle(shape, 0, 1 + side, 1 + next);
        for (uint32_t ring = 0; ring + 2 < RINGS; ++ring) {
            const uint32_t row = 1 + ring * SIDES;
            AddQuad(shape, row + side, row + SIDES + side, row + SIDES + next, row + next);
        }
        AddTriangle(shape, last, last - SIDES + next, last - SIDES + side);
    }
}

// A closed solid with a hole through it that must stay open: 2 m and 0.6 m across.
static void MakeTorus(Model* model)
{
    enum { RINGS = 48, SIDES = 20 };
    Shape* shape = AddShape(model, "torus", (Point){0, 0, 0});
    for (int ring = 0; ring < RINGS; ++ring) {
        for (int side = 0; side < SIDES; ++side) {
            const double u = 2.0 * PI * ring / RINGS;
            const double v = 2.0 * PI * side / SIDES;
            const double r = 1.0 + 0.3 * cos(v);
            AddPoint(shape, (Point){r * cos(u), 0.3 * sin(v), r * sin(u)});
        }
    }
    for (uint32_t ring = 0; ring < RINGS; ++ring) {
        const uint32_t a = ring * SIDES;
        const uint32_t b = (ring + 1) % RINGS * SIDES;
        for (uint32_t side = 0; side < SIDES; ++side) {
            const uint32_t next = (side + 1) % SIDES;
            AddQuad(shape, a + side, a + next, b + next, b + side);
        }
    }
}

// A surface that encloses nothing: hills on a square of 10 m.
static void MakeSheet(Model* model)
{
    enum { CELLS = 24 };
    Shape* shape = AddShape(model, "sheet", (Point){0, 0, 0});
    for (int j = 0; j <= CELLS; ++j) {
        for (int i = 0; i <= CELLS; ++i) {
            const double x = 10.0 * i / CELLS - 5.0;
            const double z = 10.0 * j / CELLS - 5.0;
            const double y = 0.8 * sin(0.9 * x) * cos(0.7 * z) + 0.3 * sin(1.9 * z + 0.5 * x);
            AddPoint(shape, (Point){x, y, z});
        }
    }
    for (uint32_t j = 0; j < CELLS; ++j) {
        for (uint32_t i = 0; i < CELLS; ++i) {
            const uint32_t a = j * (CELLS + 1) + i;
            AddQuad(shape, a, a + CELLS + 1, a + CELLS + 2, a + 1);
        }
    }
}

// A wall seen from outside: s runs to the right, from −half to half; its origin is the middle of
// the bottom edge.
typedef struct Wall {
    Point middle, right, out;
    double half; // [m]
} Wall;

typedef struct Opening {
    double left, right, bottom, top; // [m] in the wall's s and height
} Opening;

enum { MAX_OPENINGS = 3 };
static const double WALL_HEIGHT = 3.0, WALL_THICKNESS = 0.25;

static Point OnWall(const Wall* wall, double s, double height, double depth)
{
    const Point p = Add(wall->middle, Scale(wall->right, s));
    const Point q = Add(p, Scale(wall->out, -depth));
    return (Point){q.x, height, q.z};
}

// A rectangle of the wall at a depth; the inner side is turned round.
static void AddWallPanel(Shape* shape, const Wall* wall, const Opening* r, double depth)
{
    const Point a = OnWall(wall, r->left, r->bottom, depth);
    const Point b = OnWall(wall, r->right, r->bottom, depth);
    const Point c = OnWall(wall, r->right, r->top, depth);
    const Point d = OnWall(wall, r->left, r->top, depth);
    if (depth > 0.0) {
        AddPanel(shape, d, c, b, a);
    } else {
        AddPanel(shape, a, b, c, d);
    }
}

// One side of the wall around its openings, which stand apart and are sorted: full-height strips
// between them, then what is below and above each.
static void AddWallSide(Shape* shape, const Wall* wall, const Opening* openings, int count,
                        double depth)
{
    const double half = wall->half - depth;
    double from = -half;
    for (int i = 0; i < count; ++i) {
        const Opening o = openings[i];
        AddWallPanel(shape, wall, &(Opening){from, o.left, 0, WALL_HEIGHT}, depth);
        AddWallPanel(shape, wall, &(Opening){o.left, o.right, o.top, WALL_HEIGHT}, depth);
        if (o.bottom > 0.0) {
            AddWallPanel(shape, wall, &(Opening){o.left, o.right, 0, o.bottom}, depth);
        }
        from = o.right;
    }
    AddWallPanel(shape, wall, &(Opening){from, half, 0, WALL_HEIGHT}, depth);
}

// The four faces inside an opening; a door has no sill.
static void AddReveal(Shape* shape, const Wall* wall, const Opening* o)
{
    const double in = WALL_THICKNESS;
    const Point corners[4] = {OnWall(wall, o->left, o->bottom, 0), OnWall(wall, o->left, o->top, 0),
                              OnWall(wall, o->right, o->top, 0),
                              OnWall(wall, o->right, o->bottom, 0)};
    const Point inward = Scale(wall->out, -in);
    for (int i = 0; i < (o->bottom > 0.0 ? 4 : 3); ++i) {
        const Point a = corners[i];
        const Point b = corners[(i + 1) % 4];
        AddPanel(shape, a, Add(a, inward), Add(b, inward), b);
    }
}

static void AddWall(Shape* shape, const Wall* wall, const Opening* openings, int count)
{
    AddWallSide(shape, wall, openings, count, 0.0);
    AddWallSide(shape, wall, openings, count, WALL_THICKNESS);
    for (int i = 0; i < count; ++i) {
        AddReveal(shape, wall, &openings[i]);
    }
    // The top, mitred: without it the walls would be hollow towards the attic.
    const double half = wall->half;
    const double in = WALL_THICKNESS;
    AddPanel(shape, OnWall(wall, -half, WALL_HEIGHT, 0), OnWall(wall, half, WALL_HEIGHT, 0),
             OnWall(wall, half - in, WALL_HEIGHT, in), OnWall(wall, in - half, WALL_HEIGHT, in));
}

static void AddBox(Shape* shape, const Point p[8])
{
    static const int faces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                    {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    for (int i = 0; i < 6; ++i) {
        const int* f = faces[i];
        AddPanel(shape, p[f[0]], p[f[1]], p[f[2]], p[f[3]]);
    }
}

// Gables over the two short walls, and a slab on each side of the ridge, which runs along x.
static void AddRoof(Shape* roof, double halfX, double halfZ, double ridge)
{
    static const double EAVES = 0.4, THICKNESS = 0.2;
    const double slope = (ridge - WALL_HEIGHT) / halfZ;
    for (int side = -1; side <= 1; side += 2) {
        for (int inner = 0; inner < 2; ++inner) {
            const double x = side * (halfX - inner * WALL_THICKNESS);
            const uint32_t a = AddPoint(roof, (Point){x, WALL_HEIGHT, side * -halfZ});
            const uint32_t b = AddPoint(roof, (Point){x, WALL_HEIGHT, side * halfZ});
            const uint32_t c = AddPoint(roof, (Point){x, ridge, 0});
            AddTriangle(roof, inner ? a : b, inner ? b : a, c);
        }
        const double z = side * (halfZ + EAVES);
        const double low = WALL_HEIGHT - EAVES * slope;
        const double x = side * (halfX + EAVES);
        const Point slab[8] = {
            {-x, low, z},
            {x, low, z},
            {x, ridge, 0},
            {-x, ridge, 0},
            {-x, low + THICKNESS, z},
            {x, low + THICKNESS, z},
            {x, ridge + THICKNESS, 0},
            {-x, ridge + THICKNESS, 0},
        };
        AddBox(roof, slab);
    }
}

// A house of 8 m by 6 m: hollow, walls of 0.25 m, a door, four windows, no floor.
static void MakeHouse(Model* model)
{
    const double halfX = 4.0, halfZ = 3.0;
    const Wall front = {{0, 0, halfZ}, {1, 0, 0}, {0, 0, 1}, halfX};
    const Wall back = {{0, 0, -halfZ}, {-1, 0, 0}, {0, 0, -1}, halfX};
    const Wall left = {{-halfX, 0, 0}, {0, 0, 1}, {-1, 0, 0}, halfZ};
    const Wall right = {{halfX, 0, 0}, {0, 0, -1}, {1, 0, 0}, halfZ};
    const Opening inFront[] = {{-3.0, -1.8, 0.9, 2.1}, {-0.5, 0.5, 0, 2.1}, {1.8, 3.0, 0.9, 2.1}};
    const Opening inSide[] = {{-0.6, 0.6, 0.9, 2.1}};

    Shape* walls = AddShape(model, "walls", (Point){0, 0, 0});
    AddWall(walls, &front, inFront, 3);
    AddWall(walls, &back, inSide, 1);
    AddWall(walls, &left, inSide, 1);
    AddWall(walls, &right, NULL, 0);
    AddRoof(AddShape(model, "roof", (Point){0, 0, 0}), halfX, halfZ, 5.5);
    const Point chimney[8] = {{-0.3, -1.5, 0.3}, {-0.3, -1.5, -0.3}, {0.3, -1.5, -0.3},
                              {0.3, -1.5, 0.3},  {-0.3, 0.9, 0.3},   {-0.3, 0.9, -0.3},
                              {0.3, 0.9, -0.3},  {0.3, 0.9, 0.3}};
    AddBox(AddShape(model, "chimney", (Point){2, 5.5, -1}), chimney);
}

// A hangar of 8 m by 12 m, all of it without thickness: a door of 5 m in front, a window in the
// back, a hole in the roof's right half, no floor.
static void MakeHangar(Model* model)
{
    const double halfX = 4.0, halfZ = 6.0, ridge = 5.0;
    const Wall front = {{0, 0, halfZ}, {1, 0, 0}, {0, 0, 1}, halfX};
    const Wall back = {{0, 0, -halfZ}, {-1, 0, 0}, {0, 0, -1}, halfX};
    const Wall left = {{-halfX, 0, 0}, {0, 0, 1}, {-1, 0, 0}, halfZ};
    const Wall right = {{halfX, 0, 0}, {0, 0, -1}, {1, 0, 0}, halfZ};
    const Opening door = {-2.5, 2.5, 0, 2.5};
    const Opening window = {-1.0, 1.0, 1.0, 2.0};
    Shape* walls = AddShape(model, "walls", (Point){0, 0, 0});
    AddWallSide(walls, &front, &door, 1, 0.0);
    AddWallSide(walls, &back, &window, 1, 0.0);
    AddWallSide(walls, &left, NULL, 0, 0.0);
    AddWallSide(walls, &right, NULL, 0, 0.0);
    Shape* roof = AddShape(model, "roof", (Point){0, 0, 0});
    for (int side = -1; side <= 1; side += 2) {
        const uint32_t a = AddPoint(roof, (Point){-halfX * side, WALL_HEIGHT, halfZ * side});
        const uint32_t b = AddPoint(roof, (Point){halfX * side, WALL_HEIGHT, halfZ * side});
        const uint32_t c = AddPoint(roof, (Point){0, ridge, halfZ * side});
        AddTriangle(roof, a, b, c);
    }
    AddPanel(roof, (Point){-halfX, WALL_HEIGHT, -halfZ}, (Point){-halfX, WALL_HEIGHT, halfZ},
             (Point){0, ridge, halfZ}, (Point){0, ridge, -halfZ});
    // Strips along x around the hole, which spans z from −1 to 1 and half of the slope.
    const double strips[4][4] = {
        {1, halfZ, 0, 1}, {-halfZ, -1, 0, 1}, {-1, 1, 0, 0.25}, {-1, 1, 0.75, 1}};
    for (int i = 0; i < 4; ++i) {
        const double* s = strips[i];
        const double low = halfX * (1 - s[2]), high = halfX * (1 - s[3]);
        const double lowY = WALL_HEIGHT + (ridge - WALL_HEIGHT) * s[2];
        const double highY = WALL_HEIGHT + (ridge - WALL_HEIGHT) * s[3];
        AddPanel(roof, (Point){low, lowY, s[1]}, (Point){low, lowY, s[0]},
                 (Point){high, highY, s[0]}, (Point){high, highY, s[1]});
    }
}

typedef struct Branch {
    Point from, along; // `along` has the branch's length
    double radius;
    int level;
} Branch;

// A pointed prism, closed by a triangle fan at its thick end.
static void AddBranch(Shape* shape, const Branch* branch)
{
    const int sides = branch->level == 0 ? 7 : branch->level < 3 ? 5 : 3;
    const Point axis = Normalize(branch->along);
    const Point away = fabs(axis.y) < 0.9 ? (Point){0, 1, 0} : (Point){1, 0, 0};
    const Point u = Normalize(Cross(axis, away));
    const Point v = Cross(axis, u);
    const Point end = Add(branch->from, branch->along);
    const uint32_t first = shape->pointCount;
    for (int ring = 0; ring < 2; ++ring) {
        const double radius = branch->radius * (ring == 0 ? 1.0 : 0.6);
        for (int side = 0; side < sides; ++side) {
            const double angle = 2.0 * PI * side / sides;
            const Point off = Add(Scale(u, radius * cos(angle)), Scale(v, radius * sin(angle)));
            AddPoint(shape, Add(ring == 0 ? branch->from : end, off));
        }
    }
    const uint32_t tip = AddPoint(shape, Add(end, Scale(axis, 0.6 * branch->radius)));
    const uint32_t root = AddPoint(shape, branch->from);
    for (uint32_t side = 0; side < (uint32_t)sides; ++side) {
        const uint32_t a = first + side;
        const uint32_t b = first + (side + 1) % (uint32_t)sides;
        AddQuad(shape, a, b, b + (uint32_t)sides, a + (uint32_t)sides);
        AddTriangle(shape, a + (uint32_t)sides, b + (uint32_t)sides, tip);
        AddTriangle(shape, b, a, root);
    }
}

static void GrowBranch(Shape* shape, pvtRandom* random, const Branch* branch)
{
    enum { LEVELS = 5 };
    AddBranch(shape, branch);
    const double length =
        sqrt(branch->along.x * branch->along.x + branch->along.y * branch->along.y +
             branch->along.z * branch->along.z);
    for (int child = 0; branch->level + 1 < LEVELS && child < 3; ++child) {
        const Point axis = Normalize(branch->along);
        const Point aside =
            Normalize((Point){pvtRandom_Unit(random) - 0.5, 0.35, pvtRandom_Unit(random) - 0.5});
        const Point way = Normalize(Add(axis, Scale(aside, 1.1)));
        const double where = child == 0 ? 1.0 : 0.5 + 0.4 * pvtRandom_Unit(random);
        const Branch next = {
            Add(branch->from, Scale(branch->along, where)),
            Scale(way, length * (0.55 + 0.2 * pvtRandom_Unit(random))),
            0.55 * branch->radius,
            branch->level + 1,
        };
        GrowBranch(shape, random, &next);
    }
}

// A leafless tree of some 6 m: a real thing with next to no inside.
static void MakeTree(Model* model)
{
    pvtRandom random = pvtMakeRandom(7, 1);
    const Branch trunk = {{0, 0, 0}, {0.1, 2.4, 0.05}, 0.22, 0};
    GrowBranch(AddShape(model, "tree", (Point){0, 0, 0}), &random, &trunk);
}

// A block between two heights, of half the widths given.
static void AddBlock(Shape* shape, Point half, double bottom, double top)
{
    const Point p[8] = {{-half.x, bottom, half.z}, {-half.x, bottom, -half.z},
                        {half.x, bottom, -half.z}, {half.x, bottom, half.z},
                        {-half.x, top, half.z},    {-half.x, top, -half.z},
                        {half.x, top, -half.z},    {half.x, top, half.z}};
    AddBox(shape, p);
}

// Two closed meshes and one without an inside, as seven nodes: turned, scaled, mirrored, and with
// names that are given twice, look like made-up ones, are missing, or are no ASCII.
static void MakeYard(Model* model)
{
    Shape* tower = AddShape(model, "tower", (Point){0, 0, 0});
    AddBlock(tower, (Point){1.5, 0, 1.25}, 0.0, 1.5);
    AddBlock(tower, (Point){0.75, 0, 0.5}, 1.5, 4.0);
    Shape* wedge = AddShape(model, "wedge", (Point){0, 0, 0});
    const Point slanted[8] = {{-1, 0, 0.5}, {-1, 0, -0.5},    {1.5, 0, -0.5}, {1.5, 0, 0.5},
                              {-1, 2, 0.5}, {-1, 2.25, -0.5}, {0, 1, -0.5},   {0, 1, 0.5}};
    AddBox(wedge, slanted);
    Shape* banner = AddShape(model, "banner", (Point){0, 0, 0});
    // So narrow that no panel fits on it.
    const double height = 1.0 / 512.0;
    AddPanel(banner, (Point){0, 0, 0}, (Point){2, 0, 0}, (Point){2, height, 0},
             (Point){0, height, 0});
    const Node nodes[] = {
        {"tower", 0, {1, 1, 1}, 0, {0, 0, 0}},
        {"tower", 0, {1, 1, 1}, 0, {6, 0, -2}},
        {"tower_2", 0, {1.5, 1.5, 1.5}, 1, {-6, 0, 0}},
        {"", 1, {1, 1, 1}, 2, {0, 0, 4}},
        {"wedge", 1, {-1, 1, 1}, 0, {5, 0, 4}},
        {"M\303\244uerchen /\346\235\261$noimp", 1, {1, 2, 0.5}, 3, {-5, 0, 5}},
        {"banner", 2, {1, 1, 1}, 0, {0, 4, 0}},
    };
    for (size_t i = 0; i < sizeof nodes / sizeof *nodes; ++i) {
        AddNode(model, &nodes[i]);
    }
}

const Recipe* FindRecipe(const char* name)
{
    for (int i = 0; i < RECIPE_COUNT; ++i) {
        if (strcmp(RECIPES[i].name, name) == 0) {
            return &RECIPES[i];
        }
    }
    return NULL;
}

const Recipe RECIPES[RECIPE_COUNT] = {
    {"boulder", MakeBoulder}, {"torus", MakeTorus},
    {"house", MakeHouse},     {"sheet", MakeSheet},
    {"tree", MakeTree},       {"yard", MakeYard},
    {"fence", MakeFence},     {"leafy_tree", MakeLeafyTree},
    {"hangar", MakeHangar},
};
