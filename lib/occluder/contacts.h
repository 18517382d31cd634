// SPDX-License-Identifier: MIT
// Where triangles come near the border of what is allowed, and how to keep them from leaving it.
#ifndef PVT_OCCLUDER_CONTACTS_H
#define PVT_OCCLUDER_CONTACTS_H

#include "field.h"
#include "inside.h"
#include "triangle_set.h"

/// Of a triangle: its corners, and the point farthest outwards of each half of an edge and of each
/// quarter of what is between.
enum { PVT_MOST_CONTACTS = 13 };

/// A point of a triangle that has come near the border.
typedef struct pvtContact {
    int triangle;
    float shares[3]; ///< of the corners, of a sum of 1
    float inward[3]; ///< unit
    float depth;     ///< [vx]
    uint32_t looked; ///< so many pushes had been made when it was last found inside
} pvtContact;

typedef struct pvtContactSet {
    pvtContact* contacts; ///< in order of the triangles; those of fixed corners alone have none
    int count;
    int* counts;       ///< of each triangle
    float (*known)[3]; ///< triangle × kind of point: shares of those found the last time
    uint16_t* kinds;   ///< of each triangle: bits of the kinds that are known
    uint32_t round;    ///< how often contacts were looked for
    uint32_t* pushed;  ///< of each corner: the last push that moved it, counted from 1
    float* steps;      ///< [vx] of each corner: how far it has moved since depths were told; the
                       ///< caller's to fill in
} pvtContactSet;

typedef struct pvtContactOptions {
    const pvtInsideTest* inside; ///< what the field is of
    float band;                  ///< [vx] how near to the border a contact begins
    float piece; ///< [vx] along a side: a triangle is probed once in pieces of this size
    bool isAnew; ///< the triangles are others than the last time
} pvtContactOptions;

pvtStatus pvtCreateContacts(pvtContext* context, int triangleCapacity, pvtContactSet* contacts);
void pvtContactSet_Free(pvtContext* context, pvtContactSet* contacts);

/// Looks at points between those of the last time, and again at those that were found then.
void pvtFindContacts(pvtContext* context, const pvtContactOptions* options, const pvtField* field,
                     const pvtTriangleSet* set, pvtContactSet* contacts);
/// Depths and directions anew, at the same points of the triangles.
void pvtUpdateContacts(const pvtField* field, const pvtTriangleSet* set, pvtContactSet* contacts);
/// Takes from the corners' velocities what would move a contact nearer to the border than `band`
/// [vx] outwards, and as little else as possible: `sweeps` passes over all contacts.
void pvtSlideAlong(const pvtContactSet* contacts, float band, const pvtTriangleSet* set, int sweeps,
                   float (*velocities)[3]);
/// Moves corners so that no contact is outside. Contacts that are deeper than their corners' steps
/// could lead are not looked at.
void pvtPushInside(pvtContactSet* contacts, const pvtField* field, int sweeps, pvtTriangleSet* set);

/// [vx] where a contact's point is.
void pvtGetContactPlace(const pvtContact* contact, const pvtTriangleSet* set, float place[3]);
/// Moves the corners of a contact's triangle so that its point goes inwards by `amount` [vx].
void pvtMoveContact(const pvtContact* contact, pvtTriangleSet* set, float amount);

#endif
