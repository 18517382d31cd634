// SPDX-License-Identifier: MIT
// What the two ways of choosing a cut share.
#ifndef PVT_OCCLUDER_SELECT_H
#define PVT_OCCLUDER_SELECT_H

#include <paravent/occluder.h>

/// PVT_INVALID_ARGUMENT when an option is out of its range.
pvtStatus pvtCheckSelectOptions(pvtContext* context, const pvtSelectOptions* options);

#endif
