// SPDX-License-Identifier: MIT
// What the writers share that put their files together by hand. No locale has a say in how numbers
// look.
#ifndef PVT_IO_WRITER_HPP
#define PVT_IO_WRITER_HPP

#include "edge.hpp"

#include <charconv>
#include <cstring>

namespace pvt
{

/// Gathers bytes and hands them on piece by piece.
class Writer
{
  public:
    explicit Writer(pvtContext* context, pvtOutput* output) : context_(context), output_(output)
    {
        text_.reserve(kPiece + 256);
    }

    Writer& operator<<(const char* text)
    {
        text_ += text;
        return *this;
    }
    Writer& operator<<(const std::string& text)
    {
        text_ += text;
        return *this;
    }
    /// Numbers in the fewest digits that read back as the same number.
    template <class T> Writer& Number(T value)
    {
        char digits[48];
        const auto end = std::to_chars(digits, digits + sizeof digits, value);
        text_.append(digits, end.ptr);
        return *this;
    }
    void PutU32(std::uint32_t value)
    {
        for (int shift = 0; shift < 32; shift += 8) {
            text_.push_back(static_cast<char>(value >> shift & 0xff));
        }
    }
    /// As PutFloat writes it, lowest byte first.
    static std::uint32_t GetFloatBits(double value)
    {
        const float narrow = static_cast<float>(value);
        std::uint32_t bits;
        std::memcpy(&bits, &narrow, sizeof bits);
        return bits;
    }
    void PutFloat(double value)
    {
        PutU32(GetFloatBits(value));
    }
    void PutByte(std::uint8_t value)
    {
        text_.push_back(static_cast<char>(value));
    }

    void FlushIfFull()
    {
        if (text_.size() >= kPiece) {
            Flush();
        }
    }
    void Flush()
    {
        pvt::Poll(context_);
        pvtOutput_Write(output_, text_.data(), text_.size());
        text_.clear();
    }

  private:
    static constexpr std::size_t kPiece = 1 << 16; // [bytes]

    pvtContext* context_;
    pvtOutput* output_;
    std::string text_;
};

/// The item's name, or "node_3" where it has none.
inline std::string GetItemName(const pvtSaveJob& job, std::size_t index)
{
    const char* name = job.items[index].name;
    return name != nullptr && name[0] != '\0' ? name : "node_" + std::to_string(index);
}

} // namespace pvt

#endif
