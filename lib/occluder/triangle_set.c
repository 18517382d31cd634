// SPDX-License-Identifier: MIT
#include "triangle_set.h"

#include "base/context.h"

#include <assert.h>
#include <string.h>

void pvtTriangleSet_Free(pvtContext* context, pvtTriangleSet* set)
{
    pvtRelease(context, set->corners);
    pvtRelease(context, set->anchors);
    pvtRelease(context, set->isFixed);
    pvtRelease(context, set->triangles);
    pvtRelease(context, set->tags);
    pvtRelease(context, set->edges);
    pvtRelease(context, set->isOpen);
    pvtRelease(context, set->heads);
    pvtRelease(context, set->links);
    *set = (pvtTriangleSet){0};
}

pvtStatus pvtCreateTriangleSet(pvtContext* context, int cornerCapacity, int triangleCapacity,
                               pvtTriangleSet* set)
{
    const size_t corners = (size_t)cornerCapacity, triangles = (size_t)triangleCapacity;
    *set = (pvtTriangleSet){.cornerCapacity = cornerCapacity, .triangleCapacity = triangleCapacity};
    set->corners = pvtAllocate(context, corners, sizeof *set->corners);
    set->anchors = pvtAllocate(context, corners, sizeof *set->anchors);
    set->isFixed = pvtAllocate(context, corners, sizeof *set->isFixed);
    set->triangles = pvtAllocate(context, triangles, sizeof *set->triangles);
    set->tags = pvtAllocate(context, triangles, sizeof *set->tags);
    set->edges = pvtAllocate(context, 3 * triangles, sizeof *set->edges);
    set->isOpen = pvtAllocate(context, triangles, sizeof *set->isOpen);
    set->heads = pvtAllocate(context, corners, sizeof *set->heads);
    set->links = pvtAllocate(context, 3 * triangles, sizeof *set->links);
    if (set->corners == NULL || set->anchors == NULL || set->isFixed == NULL ||
        set->triangles == NULL || set->tags == NULL || set->edges == NULL || set->isOpen == NULL ||
        set->heads == NULL || set->links == NULL) {
        pvtTriangleSet_Free(context, set);
        return pvtContext_GetStatus(context);
    }
    return PVT_OK;
}

void pvtTriangleSet_Copy(const pvtTriangleSet* from, pvtTriangleSet* to)
{
    const size_t corners = (size_t)from->cornerCount, triangles = (size_t)from->triangleCount;
    assert(from->cornerCapacity == to->cornerCapacity);
    assert(from->triangleCapacity == to->triangleCapacity);
    to->cornerCount = from->cornerCount;
    to->triangleCount = from->triangleCount;
    memcpy(to->corners, from->corners, corners * sizeof *to->corners);
    memcpy(to->anchors, from->anchors, corners * sizeof *to->anchors);
    memcpy(to->isFixed, from->isFixed, corners * sizeof *to->isFixed);
    memcpy(to->triangles, from->triangles, triangles * sizeof *to->triangles);
    memcpy(to->tags, from->tags, triangles * sizeof *to->tags);
    pvtTriangleSet_FindEdges(to);
}

uint32_t pvtTriangleSet_AddCorner(pvtTriangleSet* set, const float place[3], bool isFixed)
{
    assert(set->cornerCount < set->cornerCapacity);
    memcpy(set->corners[set->cornerCount], place, sizeof *set->corners);
    memcpy(set->anchors[set->cornerCount], place, sizeof *set->anchors);
    set->isFixed[set->cornerCount] = isFixed;
    return (uint32_t)set->cornerCount++;
}

void pvtTriangleSet_AddTriangle(pvtTriangleSet* set, const uint32_t corners[3], int32_t tag)
{
    assert(set->triangleCount < set->triangleCapacity);
    memcpy(set->triangles[set->triangleCount], corners, sizeof *set->triangles);
    set->tags[set->triangleCount++] = tag;
}

void pvtTriangleSet_Append(pvtTriangleSet* set, const pvtTriangleSet* more)
{
    const uint32_t first = (uint32_t)set->cornerCount;
    for (int c = 0; c < more->cornerCount; ++c) {
        const uint32_t corner = pvtTriangleSet_AddCorner(set, more->corners[c], more->isFixed[c]);
        memcpy(set->anchors[corner], more->anchors[c], sizeof *set->anchors);
    }
    for (int t = 0; t < more->triangleCount; ++t) {
        const uint32_t* corners = more->triangles[t];
        pvtTriangleSet_AddTriangle(
            set, (uint32_t[3]){first + corners[0], first + corners[1], first + corners[2]},
            more->tags[t]);
    }
}

void pvtTriangleSet_Remove(pvtTriangleSet* set, int triangle)
{
    const int last = --set->triangleCount;
    memmove(set->triangles[triangle], set->triangles[last], sizeof *set->triangles);
    set->tags[triangle] = set->tags[last];
}

void pvtTriangleSet_DropCorners(pvtTriangleSet* set, int32_t* moved)
{
    // First which are used, then where each goes.
    for (int c = 0; c < set->cornerCount; ++c) {
        moved[c] = -1;
    }
    for (int t = 0; t < set->triangleCount; ++t) {
        for (int k = 0; k < 3; ++k) {
            moved[set->triangles[t][k]] = 0;
        }
    }
    int kept = 0;
    for (int c = 0; c < set->cornerCount; ++c) {
        if (moved[c] == 0) {
            memmove(set->corners[kept], set->corners[c], sizeof *set->corners);
            memmove(set->anchors[kept], set->anchors[c], sizeof *set->anchors);
            set->isFixed[kept] = set->isFixed[c];
            moved[c] = kept++;
        }
    }
    for (int t = 0; t < set->triangleCount; ++t) {
        for (int k = 0; k < 3; ++k) {
            set->triangles[t][k] = (uint32_t)moved[set->triangles[t][k]];
        }
    }
    for (int c = 0; c < set->cornerCount; ++c) {
        if (moved[c] >= 0) {
            // Never beyond c, so that what is still to be read stays.
            moved[moved[c]] = c;
        }
    }
    set->cornerCount = kept;
}

// The edge between two corners that has but one side yet; a new one when there is none.
static pvtTriangleEdge* FindEdge(pvtTriangleSet* set, uint32_t a, uint32_t b)
{
    const uint32_t low = a < b ? a : b, high = a < b ? b : a;
    for (int32_t e = set->heads[low]; e >= 0; e = set->links[e]) {
        if (set->edges[e].ends[1] == high && set->edges[e].sideCount < 2) {
            return &set->edges[e];
        }
    }
    const int32_t added = set->edgeCount++;
    set->edges[added] = (pvtTriangleEdge){.ends = {low, high}};
    set->links[added] = set->heads[low];
    set->heads[low] = added;
    return &set->edges[added];
}

void pvtTriangleSet_FindEdges(pvtTriangleSet* set)
{
    set->edgeCount = 0;
    for (int c = 0; c < set->cornerCount; ++c) {
        set->heads[c] = -1;
    }
    for (int t = 0; t < set->triangleCount; ++t) {
        const uint32_t* corners = set->triangles[t];
        for (int k = 0; k < 3; ++k) {
            pvtTriangleEdge* edge = FindEdge(set, corners[k], corners[(k + 1) % 3]);
            edge->across[edge->sideCount++] = corners[(k + 2) % 3];
        }
    }
    for (int t = 0; t < set->triangleCount; ++t) {
        const uint32_t* corners = set->triangles[t];
        for (int k = 0; k < 3; ++k) {
            const uint32_t a = corners[k], b = corners[(k + 1) % 3];
            const uint32_t low = a < b ? a : b, high = a < b ? b : a;
            set->isOpen[t][k] = true;
            for (int32_t e = set->heads[low]; e >= 0; e = set->links[e]) {
                if (set->edges[e].ends[1] == high && set->edges[e].sideCount == 2) {
                    set->isOpen[t][k] = false;
                }
            }
        }
    }
}
