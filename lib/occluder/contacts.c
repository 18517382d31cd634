// SPDX-License-Identifier: MIT
// Position-based constraints (Müller et al., Position Based Dynamics, 2007). A triangle is cut into
// four again and again; pieces that are deeper inside than they are large are done with, and what
// is left at the border has the size of a few voxels. Each of these is probed at one point, another
// one each time, and what was found is kept: so after a few times there is no bump between the
// points. A contact moves the corners of its triangle by their share in it.
#include "contacts.h"

#include "base/context.h"
#include "base/random.h"

#include <math.h>
#include <string.h>

enum { MOST_SPLITS = 7, GROUP = 4, STREAM = 0xC047 };

static const float FARTHEST = 0.67F; // of the longest side: from the middle to a corner
// Pieces are not cut further below this: what lies along a wall as a whole would be cut into too
// many.
static const float PART = 1.0F / 12.0F; // of the triangle's side
static const float STEEPEST = 1.25F;    // [vx] that depths change by along a voxel

void pvtContactSet_Free(pvtContext* context, pvtContactSet* contacts)
{
    pvtRelease(context, contacts->contacts);
    pvtRelease(context, contacts->counts);
    pvtRelease(context, contacts->known);
    pvtRelease(context, contacts->kinds);
    pvtRelease(context, contacts->pushed);
    pvtRelease(context, contacts->steps);
    *contacts = (pvtContactSet){0};
}

pvtStatus pvtCreateContacts(pvtContext* context, int triangleCapacity, pvtContactSet* contacts)
{
    const size_t triangles = (size_t)triangleCapacity;
    const size_t points = triangles * PVT_MOST_CONTACTS;
    *contacts = (pvtContactSet){0};
    contacts->contacts = pvtAllocate(context, points, sizeof *contacts->contacts);
    contacts->counts = pvtAllocate(context, triangles, sizeof *contacts->counts);
    contacts->known = pvtAllocate(context, points, sizeof *contacts->known);
    contacts->kinds = pvtAllocate(context, triangles, sizeof *contacts->kinds);
    contacts->pushed = pvtAllocate(context, 3 * triangles, sizeof *contacts->pushed);
    contacts->steps = pvtAllocate(context, 3 * triangles, sizeof *contacts->steps);
    if (contacts->contacts == NULL || contacts->counts == NULL || contacts->known == NULL ||
        contacts->kinds == NULL || contacts->pushed == NULL || contacts->steps == NULL) {
        pvtContactSet_Free(context, contacts);
        return pvtContext_GetStatus(context);
    }
    return PVT_OK;
}

typedef struct Probe {
    const pvtInsideTest* inside;
    const pvtField* field;
    float corners[3][3];
    float side;                      // [vx] the longest
    float piece;                     // [vx] as the options tell
    float at[2];                     // of a smallest piece: where it is probed, as parts of it
    float limit;                     // [vx] depth from which on points are of no interest
    float depths[PVT_MOST_CONTACTS]; // the least of each kind
    float shares[PVT_MOST_CONTACTS][3];
} Probe;

static void GetPoint(const float corners[3][3], const float shares[3], float point[3])
{
    for (int axis = 0; axis < 3; ++axis) {
        point[axis] = shares[0] * corners[0][axis] + shares[1] * corners[1][axis] +
                      shares[2] * corners[2][axis];
    }
}

// Corners are 0 to 2, the halves of the edges 3 to 8, the quarters of the rest 9 to 12.
static int GetKind(const float shares[3])
{
    int most = 0;
    for (int k = 0; k < 3; ++k) {
        most = shares[k] > shares[most] ? k : most;
    }
    if (shares[most] > 0.999F) {
        return most;
    }
    for (int k = 0; k < 3; ++k) {
        if (shares[k] < 0.001F) {
            return 3 + 2 * k + (most == (k + 1) % 3 ? 1 : 0);
        }
    }
    return shares[most] > 0.5F ? 9 + most : 12;
}

static void ProbePoint(Probe* probe, float a, float b, float c)
{
    const float shares[3] = {a, b, c};
    float point[3];
    GetPoint((const float(*)[3])probe->corners, shares, point);
    if (pvtField_GetLeastDepth(probe->field, point) >= probe->limit) {
        return;
    }
    const float depth = pvtField_GetDepth(probe->field, point);
    const int kind = GetKind(shares);
    if (depth < probe->depths[kind]) {
        probe->depths[kind] = depth;
        memcpy(probe->shares[kind], shares, sizeof probe->shares[kind]);
    }
}

// One point of a smallest piece, and as many on the edges of the triangle that it has a part in.
static void ProbeWithin(Probe* probe, const float at[2], float size)
{
    const float u = at[0] + size * probe->at[0], v = at[1] + size * probe->at[1];
    ProbePoint(probe, 1.0F - u - v, u, v);
    if (size < 0.0F) {
        return;
    }
    if (at[0] < 0.001F) {
        ProbePoint(probe, 1.0F - v, 0.0F, v);
    }
    if (at[1] < 0.001F) {
        ProbePoint(probe, 1.0F - u, u, 0.0F);
    }
    if (at[0] + at[1] + size > 0.999F) {
        ProbePoint(probe, 0.0F, u, 1.0F - u);
    }
}

// A piece from corner `at`, half as large at each split; turned upside down when `size` is
// negative.
static void ProbePiece(Probe* probe, const float at[2], float size, int splits)
{
    const float third = size / 3.0F;
    const float middle[3] = {1.0F - at[0] - at[1] - 2.0F * third, at[0] + third, at[1] + third};
    const float extent = fabsf(size) * probe->side;
    float point[3];
    GetPoint((const float(*)[3])probe->corners, middle, point);
    if (pvtInsideTest_HasBall(probe->inside, point, FARTHEST * extent + probe->limit)) {
        return;
    }
    if (splits == 0 || extent < probe->piece || fabsf(size) < PART) {
        ProbeWithin(probe, at, size);
        return;
    }
    const float half = 0.5F * size;
    ProbePiece(probe, at, half, splits - 1);
    ProbePiece(probe, (float[2]){at[0] + half, at[1]}, half, splits - 1);
    ProbePiece(probe, (float[2]){at[0], at[1] + half}, half, splits - 1);
    ProbePiece(probe, (float[2]){at[0] + half, at[1] + half}, -half, splits - 1);
}

typedef struct ContactTask {
    const pvtContactOptions* options;
    const pvtField* field;
    const pvtTriangleSet* set;
    pvtContactSet* contacts;
} ContactTask;

static void StartProbe(const ContactTask* task, int triangle, Probe* probe)
{
    probe->inside = task->options->inside;
    probe->field = task->field;
    probe->piece = task->options->piece;
    probe->limit = task->options->band;
    pvtRandom random = pvtMakeRandom(task->contacts->round, STREAM);
    const float u = (float)pvtRandom_Unit(&random), v = (float)pvtRandom_Unit(&random);
    probe->at[0] = u + v < 1.0F ? u : 1.0F - u;
    probe->at[1] = u + v < 1.0F ? v : 1.0F - v;
    for (int k = 0; k < 3; ++k) {
        memcpy(probe->corners[k], task->set->corners[task->set->triangles[triangle][k]],
               sizeof probe->corners[k]);
    }
    float longest = 0.0F;
    for (int k = 0; k < 3; ++k) {
        float length = 0.0F;
        for (int axis = 0; axis < 3; ++axis) {
            const float d = probe->corners[k][axis] - probe->corners[(k + 1) % 3][axis];
            length += d * d;
        }
        longest = length > longest ? length : longest;
    }
    probe->side = sqrtf(longest);
    for (int kind = 0; kind < PVT_MOST_CONTACTS; ++kind) {
        probe->depths[kind] = probe->limit;
    }
}

static void ProbeTriangle(const ContactTask* task, int triangle, Probe* probe)
{
    const pvtContactSet* set = task->contacts;
    const float(*known)[3] = (const float(*)[3])set->known + (size_t)triangle * PVT_MOST_CONTACTS;
    for (int k = 0; k < 3; ++k) {
        ProbePoint(probe, k == 0 ? 1.0F : 0.0F, k == 1 ? 1.0F : 0.0F, k == 2 ? 1.0F : 0.0F);
    }
    for (int kind = 3; kind < PVT_MOST_CONTACTS && !task->options->isAnew; ++kind) {
        if ((set->kinds[triangle] >> kind & 1) != 0) {
            ProbePoint(probe, known[kind][0], known[kind][1], known[kind][2]);
        }
    }
    ProbePiece(probe, (float[2]){0.0F, 0.0F}, 1.0F, MOST_SPLITS);
}

static int ListContacts(const ContactTask* task, int triangle, const Probe* probe)
{
    const pvtContactSet* set = task->contacts;
    pvtContact* contacts = set->contacts + (size_t)triangle * PVT_MOST_CONTACTS;
    int count = 0;
    set->kinds[triangle] = 0;
    for (int kind = 0; kind < PVT_MOST_CONTACTS; ++kind) {
        if (!(probe->depths[kind] < probe->limit)) {
            continue;
        }
        pvtContact* contact = &contacts[count++];
        contact->triangle = triangle;
        memcpy(contact->shares, probe->shares[kind], sizeof contact->shares);
        memcpy(set->known[(size_t)triangle * PVT_MOST_CONTACTS + (size_t)kind], contact->shares,
               sizeof contact->shares);
        set->kinds[triangle] |= (uint16_t)(1U << kind);
        float point[3];
        GetPoint((const float(*)[3])probe->corners, contact->shares, point);
        contact->depth = pvtField_GetDepthAndInward(task->field, point, contact->inward);
    }
    return count;
}

static void ProbeTriangles(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const ContactTask* task = taskData;
    for (int t = (int)begin; t < (int)end; ++t) {
        Probe probe;
        StartProbe(task, t, &probe);
        if (!pvtTriangleSet_IsFixed(task->set, t)) {
            ProbeTriangle(task, t, &probe);
        }
        task->contacts->counts[t] = ListContacts(task, t, &probe);
    }
}

void pvtFindContacts(pvtContext* context, const pvtContactOptions* options, const pvtField* field,
                     const pvtTriangleSet* set, pvtContactSet* contacts)
{
    ++contacts->round;
    ContactTask task = {options, field, set, contacts};
    pvtParallelFor(context, ProbeTriangles, (size_t)set->triangleCount, GROUP, &task);
    contacts->count = 0;
    for (int t = 0; t < set->triangleCount; ++t) {
        memmove(contacts->contacts + contacts->count,
                contacts->contacts + (size_t)t * PVT_MOST_CONTACTS,
                (size_t)contacts->counts[t] * sizeof *contacts->contacts);
        contacts->count += contacts->counts[t];
    }
}

// Σ share² over the corners that may move.
static float GetMobility(const pvtTriangleSet* set, const pvtContact* contact)
{
    const uint32_t* corners = set->triangles[contact->triangle];
    float sum = 0.0F;
    for (int k = 0; k < 3; ++k) {
        sum += set->isFixed[corners[k]] ? 0.0F : contact->shares[k] * contact->shares[k];
    }
    return sum;
}

static void MoveCorners(const pvtTriangleSet* set, const pvtContact* contact,
                        const float direction[3], float amount, float (*places)[3])
{
    const uint32_t* corners = set->triangles[contact->triangle];
    const float mobility = GetMobility(set, contact);
    for (int k = 0; k < 3 && mobility > 0.0F; ++k) {
        if (!set->isFixed[corners[k]]) {
            for (int axis = 0; axis < 3; ++axis) {
                places[corners[k]][axis] +=
                    amount / mobility * contact->shares[k] * direction[axis];
            }
        }
    }
}

void pvtGetContactPlace(const pvtContact* contact, const pvtTriangleSet* set, float place[3])
{
    float corners[3][3];
    for (int k = 0; k < 3; ++k) {
        memcpy(corners[k], set->corners[set->triangles[contact->triangle][k]], sizeof corners[k]);
    }
    GetPoint((const float(*)[3])corners, contact->shares, place);
}

void pvtUpdateContacts(const pvtField* field, const pvtTriangleSet* set, pvtContactSet* contacts)
{
    for (int i = 0; i < contacts->count; ++i) {
        float point[3];
        pvtGetContactPlace(&contacts->contacts[i], set, point);
        contacts->contacts[i].depth =
            pvtField_GetDepthAndInward(field, point, contacts->contacts[i].inward);
    }
}

void pvtSlideAlong(const pvtContactSet* contacts, float band, const pvtTriangleSet* set, int sweeps,
                   float (*velocities)[3])
{
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (int i = 0; i < contacts->count; ++i) {
            const pvtContact* contact = &contacts->contacts[i];
            const uint32_t* corners = set->triangles[contact->triangle];
            float speed = 0.0F;
            for (int k = 0; k < 3; ++k) {
                const float* v = velocities[corners[k]];
                speed +=
                    contact->shares[k] * (v[0] * contact->inward[0] + v[1] * contact->inward[1] +
                                          v[2] * contact->inward[2]);
            }
            if (speed < 0.0F && contact->depth < band) {
                MoveCorners(set, contact, contact->inward, -speed, velocities);
            }
        }
    }
}

// Whether a corner of its triangle has moved since the contact was found inside.
static bool HasMoved(const pvtContactSet* contacts, const pvtTriangleSet* set,
                     const pvtContact* contact)
{
    const uint32_t* corners = set->triangles[contact->triangle];
    return contacts->pushed[corners[0]] > contact->looked ||
           contacts->pushed[corners[1]] > contact->looked ||
           contacts->pushed[corners[2]] > contact->looked;
}

// Whether a contact may have left the inside by its corners' steps.
static bool MayBeOutside(const pvtContactSet* contacts, const pvtTriangleSet* set,
                         const pvtContact* contact)
{
    const uint32_t* corners = set->triangles[contact->triangle];
    float step = 0.0F;
    for (int k = 0; k < 3; ++k) {
        step += contact->shares[k] * contacts->steps[corners[k]];
    }
    return contact->depth < STEEPEST * step;
}

void pvtPushInside(pvtContactSet* contacts, const pvtField* field, int sweeps, pvtTriangleSet* set)
{
    uint32_t pushes = 0;
    memset(contacts->pushed, 0, (size_t)set->cornerCount * sizeof *contacts->pushed);
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (int i = 0; i < contacts->count; ++i) {
            pvtContact* contact = &contacts->contacts[i];
            if (sweep == 0) {
                contact->looked = 0;
            }
            if (!HasMoved(contacts, set, contact) &&
                (sweep > 0 || !MayBeOutside(contacts, set, contact))) {
                continue;
            }
            float point[3], inward[3];
            pvtGetContactPlace(contact, set, point);
            const float depth = pvtField_GetDepthAndInward(field, point, inward);
            contact->looked = pushes;
            if (depth < 0.0F) {
                ++pushes;
                MoveCorners(set, contact, inward, -depth, set->corners);
                for (int k = 0; k < 3; ++k) {
                    contacts->pushed[set->triangles[contact->triangle][k]] = pushes;
                }
            }
        }
    }
}

void pvtMoveContact(const pvtContact* contact, pvtTriangleSet* set, float amount)
{
    MoveCorners(set, contact, contact->inward, amount, set->corners);
}
