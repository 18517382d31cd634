// SPDX-License-Identifier: MIT
// The C++ edge: failures travel as exceptions inside, and never leave an extern "C" function.
#ifndef PVT_IO_EDGE_HPP
#define PVT_IO_EDGE_HPP

#include "formats.h"
#include "text.h"

#include <cassert>
#include <cstdarg>
#include <cstddef>
#include <exception>
#include <new>
#include <string>
#include <utility>

extern "C" {
#include "base/context.h"
}

namespace pvt
{

/// Thrown once pvtFail has taken the text.
struct Failure {
    pvtStatus status;
};

/// PVT_INVALID_INPUT, or another status, with the file's path in front of the text.
[[noreturn]] void Refuse(const pvtLoadJob& job, const char* format, ...)
    __attribute__((format(printf, 2, 3)));
[[noreturn]] void Refuse(const pvtLoadJob& job, pvtStatus status, const char* format, ...)
    __attribute__((format(printf, 3, 4)));
void Warn(const pvtLoadJob& job, const char* format, ...) __attribute__((format(printf, 2, 3)));

/// Passes a C function's failure on.
inline void Check(pvtStatus status)
{
    if (status != PVT_OK) {
        throw Failure{status};
    }
}

/// Throws when the caller asked to stop.
inline void Poll(pvtContext* context)
{
    if (pvtIsCancelled(context)) {
        throw Failure{pvtFailCancelled(context)};
    }
}

/// A text out of a file, made fit for a message.
inline std::string Clean(const std::string& text)
{
    char buffer[PVT_NAME_SIZE];
    return pvtCleanName(text.c_str(), buffer);
}

/// The whole of a text as valid UTF-8 without control characters, to be written.
std::string CopyClean(pvtContext* context, const char* text);

/// Runs `body` and turns whatever it throws into a status. `what` is the file, for the text.
template <class Body> pvtStatus Guard(pvtContext* context, const char* what, Body&& body) noexcept
{
    try {
        body();
        return PVT_OK;
    } catch (const Failure& failure) {
        return failure.status;
    } catch (const std::bad_alloc&) {
        return pvtFail(context, PVT_OUT_OF_MEMORY, "%s: memory ran out", what);
    } catch (const std::exception& error) {
        char text[PVT_NAME_SIZE];
        return pvtFail(context, PVT_INVALID_INPUT, "%s: %s", what,
                       pvtCleanName(error.what(), text));
    } catch (...) {
        return pvtFail(context, PVT_INVALID_INPUT, "%s: it cannot be read", what);
    }
}

/// A growing array of plain values in the context's accounted memory.
template <class T> class Array
{
  public:
    explicit Array(pvtContext* context) : context_(context)
    {
    }
    Array(Array&& other) noexcept
        : context_(other.context_), data_(std::exchange(other.data_, nullptr)),
          size_(std::exchange(other.size_, 0)), room_(std::exchange(other.room_, 0))
    {
    }
    Array& operator=(Array&& other) noexcept
    {
        std::swap(context_, other.context_);
        std::swap(data_, other.data_);
        std::swap(size_, other.size_);
        std::swap(room_, other.room_);
        return *this;
    }
    ~Array()
    {
        pvtRelease(context_, data_);
    }

    void Reserve(std::size_t room)
    {
        if (room > room_) {
            void* grown = pvtReallocate(context_, data_, room, sizeof(T));
            if (grown == nullptr) {
                throw Failure{pvtContext_GetStatus(context_)};
            }
            data_ = static_cast<T*>(grown);
            room_ = room;
        }
    }
    /// New elements are zero.
    void Resize(std::size_t size)
    {
        Reserve(size);
        size_ = size;
    }
    void Push(const T& value)
    {
        if (size_ == room_) {
            Reserve(room_ < 64 ? 64 : room_ + room_ / 2);
        }
        data_[size_++] = value;
    }
    void Clear()
    {
        pvtRelease(context_, data_);
        data_ = nullptr;
        size_ = room_ = 0;
    }

    T& operator[](std::size_t i)
    {
        assert(i < size_);
        return data_[i];
    }
    const T& operator[](std::size_t i) const
    {
        assert(i < size_);
        return data_[i];
    }
    T* Data() const
    {
        return data_;
    }
    std::size_t Size() const
    {
        return size_;
    }

  private:
    pvtContext* context_;
    T* data_ = nullptr;
    std::size_t size_ = 0, room_ = 0;
};

} // namespace pvt

#endif
