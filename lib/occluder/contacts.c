// SPDX-License-Identifier: MIT
// Position-based constraints (Müller et al., Position Based Dynamics, 2007). A triangle is cut into
// four again and again; pieces that are deeper inside than they are large are done with, and what
// is left at the border has the size of a few voxels. A contact moves the corners of its triangle
// by their share in it.
#include "contacts.h"

#include "base/context.h"

#include <math.h>
#include <string.h>

enum { MOST_SPLITS = 7, GROUP = 4 };

// Pieces are not cut further below this along a side: what lies along a wall as a whole would be
// cut into too many.
static const float PIECE = 5.0F;        // [vx]
static const float FARTHEST = 0.67F;    // of the longest side: from the middle to a corner
static const float PART = 1.0F / 12.0F; // of the triangle's side

void pvtContactSet_Free(pvtContext* context, pvtContactSet* contacts)
{
    pvtRelease(context, contacts->contacts);
    pvtRelease(context, contacts->counts);
    *contacts = (pvtContactSet){0};
}

pvtStatus pvtCreateContacts(pvtContext* context, int triangleCapacity, pvtContactSet* contacts)
{
    *contacts = (pvtContactSet){0};
    contacts->contacts = pvtAllocate(context, (size_t)triangleCapacity * PVT_MOST_CONTACTS,
                                     sizeof *contacts->contacts);
    contacts->counts = pvtAllocate(context, (size_t)triangleCapacity, sizeof *contacts->counts);
    if (contacts->contacts == NULL || contacts->counts == NULL) {
        pvtContactSet_Free(context, contacts);
        return pvtContext_GetStatus(context);
    }
    return PVT_OK;
}

typedef struct Probe {
    const pvtField* field;
    float corners[3][3];
    float side;                      // [vx] the longest
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

// Corners are 0 to 2, the edges from them to the next 3 to 5, the rest 6.
static int GetKind(const float shares[3])
{
    for (int k = 0; k < 3; ++k) {
        if (shares[k] > 0.999F) {
            return k;
        }
    }
    for (int k = 0; k < 3; ++k) {
        if (shares[k] < 0.001F) {
            return 3 + (k + 1) % 3;
        }
    }
    return 6;
}

static float ProbePoint(Probe* probe, const float shares[3])
{
    float point[3];
    GetPoint((const float(*)[3])probe->corners, shares, point);
    const float depth = pvtField_GetDepth(probe->field, point);
    const int kind = GetKind(shares);
    if (depth < probe->depths[kind]) {
        probe->depths[kind] = depth;
        memcpy(probe->shares[kind], shares, sizeof probe->shares[kind]);
    }
    return depth;
}

// Of a smallest piece: pieces share their corners, so that each looks at the one which no piece
// beside it does, and at those on the edge between corners 1 and 2.
static void ProbeEnds(Probe* probe, const float at[2], float size)
{
    const float ends[3][2] = {{at[0], at[1]}, {at[0] + size, at[1]}, {at[0], at[1] + size}};
    for (int k = 0; k < 3 && size > 0.0F; ++k) {
        const float shares[3] = {1.0F - ends[k][0] - ends[k][1], ends[k][0], ends[k][1]};
        if (k == 0 || shares[0] < 0.001F) {
            ProbePoint(probe, shares);
        }
    }
}

// A piece from corner `at`, half as large at each split; turned upside down when `size` is
// negative.
static void ProbePiece(Probe* probe, const float at[2], float size, int splits)
{
    const float third = size / 3.0F;
    const float middle[3] = {1.0F - at[0] - at[1] - 2.0F * third, at[0] + third, at[1] + third};
    const float extent = fabsf(size) * probe->side;
    const float depth = ProbePoint(probe, middle);
    if (depth - FARTHEST * extent > probe->limit) {
        return;
    }
    if (splits == 0 || extent < PIECE || fabsf(size) < PART) {
        ProbeEnds(probe, at, size);
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
    *probe = (Probe){.field = task->field,
                     .limit = task->options->margins[triangle] + task->options->band};
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

static void ProbeTriangles(size_t begin, size_t end, int worker, void* taskData)
{
    (void)worker;
    const ContactTask* task = taskData;
    for (int t = (int)begin; t < (int)end; ++t) {
        pvtContact* contacts = task->contacts->contacts + (size_t)t * PVT_MOST_CONTACTS;
        int count = 0;
        Probe probe;
        StartProbe(task, t, &probe);
        if (!pvtTriangleSet_IsFixed(task->set, t)) {
            ProbePiece(&probe, (float[2]){0.0F, 0.0F}, 1.0F, MOST_SPLITS);
        }
        for (int kind = 0; kind < PVT_MOST_CONTACTS; ++kind) {
            if (probe.depths[kind] < probe.limit) {
                pvtContact* contact = &contacts[count++];
                contact->triangle = t;
                memcpy(contact->shares, probe.shares[kind], sizeof contact->shares);
                float point[3];
                GetPoint((const float(*)[3])probe.corners, contact->shares, point);
                contact->depth = pvtField_GetDepthAndInward(task->field, point, contact->inward);
            }
        }
        task->contacts->counts[t] = count;
    }
}

void pvtFindContacts(pvtContext* context, const pvtContactOptions* options, const pvtField* field,
                     const pvtTriangleSet* set, pvtContactSet* contacts)
{
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

static void GetContactPoint(const pvtTriangleSet* set, const pvtContact* contact, float point[3])
{
    float corners[3][3];
    for (int k = 0; k < 3; ++k) {
        memcpy(corners[k], set->corners[set->triangles[contact->triangle][k]], sizeof corners[k]);
    }
    GetPoint((const float(*)[3])corners, contact->shares, point);
}

void pvtUpdateContacts(const pvtField* field, const pvtTriangleSet* set, pvtContactSet* contacts)
{
    for (int i = 0; i < contacts->count; ++i) {
        float point[3];
        GetContactPoint(set, &contacts->contacts[i], point);
        contacts->contacts[i].depth =
            pvtField_GetDepthAndInward(field, point, contacts->contacts[i].inward);
    }
}

void pvtSlideAlong(const pvtContactOptions* options, const pvtContactSet* contacts,
                   const pvtTriangleSet* set, int sweeps, float (*velocities)[3])
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
            const bool isNear =
                contact->depth < options->margins[contact->triangle] + options->band;
            if (speed < 0.0F && isNear) {
                MoveCorners(set, contact, contact->inward, -speed, velocities);
            }
        }
    }
}

void pvtPushInside(const pvtContactSet* contacts, const pvtField* field, const float* margins,
                   int sweeps, pvtTriangleSet* set)
{
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (int i = 0; i < contacts->count; ++i) {
            const pvtContact* contact = &contacts->contacts[i];
            float point[3], inward[3];
            GetContactPoint(set, contact, point);
            const float depth = pvtField_GetDepthAndInward(field, point, inward);
            const float lack = margins[contact->triangle] - depth;
            if (lack > 0.0F) {
                MoveCorners(set, contact, inward, lack, set->corners);
            }
        }
    }
}

void pvtMoveContact(const pvtContact* contact, pvtTriangleSet* set, float amount)
{
    MoveCorners(set, contact, contact->inward, amount, set->corners);
}
