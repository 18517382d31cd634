// SPDX-License-Identifier: MIT
// The words of options that several commands take, each at the place of its value in the library's
// enumeration; null behind the last.
#ifndef PVT_APP_CHOICES_H
#define PVT_APP_CHOICES_H

extern const char* const pvtAxisChoices[];       ///< of pvtAxis
extern const char* const pvtMethodChoices[];     ///< of pvtMethod
extern const char* const pvtEffortChoices[];     ///< of pvtEffort
extern const char* const pvtMaskedChoices[];     ///< of pvtMasked
extern const char* const pvtConventionChoices[]; ///< of pvtConvention

#endif
