// SPDX-License-Identifier: MIT
// Option values: from text, to text, and in words. Independent of the locale.
#ifndef PVT_APP_VALUES_H
#define PVT_APP_VALUES_H

#include "options.h"

/// Reads `text` into `field`, of the option's type. False with a message that names the option, the
/// value and what is allowed.
bool pvtReadValue(const pvtOption* option, const char* text, void* field, char* message,
                  size_t messageSize);

/// "1 to 65535", "above 0", "0 or more", or nothing when any value is allowed.
void pvtDescribeRange(const pvtOption* option, char* text, size_t size);

/// What the option takes: "a whole number, 1 to 65535", "planar or paper".
void pvtDescribeValue(const pvtOption* option, char* text, size_t size);

/// The field's value as the option would be given it: "64", "2vx", "512M", "planar".
void pvtPrintValue(const pvtOption* option, const void* field, char* text, size_t size);

/// A finite decimal number that is the whole of `text`; no hexadecimal, no "inf", no "nan".
bool pvtReadNumber(const char* text, double* number);

/// The shortest of 15 to 17 digits that read back as the same double, with a decimal point.
/// `number` is finite; `text` has room for 32 bytes.
void pvtPrintNumber(double number, char text[32]);

#endif
