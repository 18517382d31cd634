// SPDX-License-Identifier: MIT
#ifndef PVT_SECTION_COVER_H
#define PVT_SECTION_COVER_H

#include <paravent/section.h>

/// True when every cell whose interior the triangle touches is set; exact. A cell is `unit` point
/// units wide, a power of two. The triangle may wind either way; one without area touches nothing.
bool pvtIsTriangleCovered(const pvtBitmap* cells, int32_t unit, const pvtPoint2 corners[3]);

/// The same for a segment; one that runs along the border between cells touches none.
bool pvtIsSegmentCovered(const pvtBitmap* cells, int32_t unit, pvtPoint2 from, pvtPoint2 to);

#endif
