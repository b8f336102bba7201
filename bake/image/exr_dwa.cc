/* EXR pixels through OpenEXR's C++ library, which decodes DWAA and DWAB where its C library (before 3.2) does not. No
 * C++ type or exception leaves this file. */
#include "image/exr_internal.h"

#include <cstring>
#include <exception>
#include <new>

#include <OpenEXR/Iex.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>

namespace {

/* A file in memory. */
class memory_stream : public Imf::IStream {
  public:
    explicit memory_stream(const lmb_image_bytes *file) : Imf::IStream(file->name), data_(file->data), size_(file->size)
    {
    }

    bool read(char bytes[], int count) override
    {
        if (count < 0 || at_ > size_ || static_cast<uint64_t>(count) > size_ - at_) {
            throw Iex::InputExc("the file is too short");
        }
        std::memcpy(bytes, data_ + at_, static_cast<size_t>(count));
        at_ += static_cast<uint64_t>(count);
        return at_ < size_;
    }

    uint64_t tellg() override
    {
        return at_;
    }

    void seekg(uint64_t position) override
    {
        at_ = position;
    }

  private:
    const unsigned char *data_;
    uint64_t size_;
    uint64_t at_ = 0;
};

void pixels_read(const lmb_image_bytes *from, const lmb_exr_targets *targets)
{
    memory_stream stream(from);
    Imf::InputFile file(stream, 0);
    const Imath::Box2i window = file.header().dataWindow();
    Imf::FrameBuffer buffer;
    for (size_t i = 0; i < targets->count; ++i) {
        const lmb_exr_target &target = targets->target[i];
        const size_t step = static_cast<size_t>(target.stride) * sizeof(float);
        buffer.insert(target.channel, Imf::Slice::Make(Imf::FLOAT, target.base, window, step,
                                                       step * static_cast<size_t>(targets->width)));
    }
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
}

} // namespace

lmb_result lmb_exr_decode_dwa(const lmb_image_bytes *file, const lmb_exr_targets *targets, lmb_error *error)
{
    try {
        pixels_read(file, targets);
        return LMB_OK;
    } catch (const std::bad_alloc &) {
        return lmb_error_set(error, LMB_ERROR_MEMORY, "%s: no memory to decode the EXR's pixels", file->name);
    } catch (const std::exception &fault) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: cannot decode the EXR's pixels: %s", file->name,
                             fault.what());
    } catch (...) {
        return lmb_error_set(error, LMB_ERROR_FORMAT, "%s: cannot decode the EXR's pixels", file->name);
    }
}
