// The UUID of a .vdb file as a hash of its content.
#include "vdb_internal.hh"

#include <lambent/file.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>

namespace lmb_vdb {
namespace {

// Magic, file version, library version and one flag come before the UUID.
constexpr std::streamoff kUuidOffset = 21;

// Of version 8 (free form, RFC 9562) from the file's bytes outside the UUID: two 64-bit FNV-1a hashes with different
// seeds. OpenVDB's own are random and of version 4.
std::string content_uuid(std::istream &file)
{
    uint64_t hash[2] = {LMB_HASH_SEED, lmb_hash(LMB_HASH_SEED, "lambent", 7)};
    std::vector<char> buffer(1 << 16);
    const auto add = [&](size_t wanted) {
        file.read(buffer.data(), static_cast<std::streamsize>(wanted));
        const size_t got = static_cast<size_t>(file.gcount());
        for (uint64_t &h : hash) {
            h = lmb_hash(h, buffer.data(), got);
        }
        return got == wanted;
    };
    file.seekg(0);
    if (add(static_cast<size_t>(kUuidOffset))) {
        file.seekg(kUuidOffset + static_cast<std::streamoff>(kUuidLength));
        while (add(buffer.size())) {
        }
    }
    const uint64_t high = (hash[0] & ~UINT64_C(0xf000)) | UINT64_C(0x8000);
    const uint64_t low = (hash[1] & ~(UINT64_C(3) << 62)) | UINT64_C(2) << 62;
    char text[kUuidLength + 1];
    std::snprintf(text, sizeof text, "%08x-%04x-%04x-%04x-%012llx", static_cast<unsigned>(high >> 32),
                  static_cast<unsigned>(high >> 16 & 0xffff), static_cast<unsigned>(high & 0xffff),
                  static_cast<unsigned>(low >> 48), static_cast<unsigned long long>(low & UINT64_C(0xffffffffffff)));
    return text;
}

} // namespace

void overwrite_uuid(const std::string &path)
{
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    const std::string uuid = content_uuid(file);
    if (file.bad() || !file.eof()) {
        fail(LMB_ERROR_WRITE, std::string("cannot write: ") + std::strerror(errno));
    }
    file.clear();
    file.seekp(kUuidOffset);
    file.write(uuid.data(), static_cast<std::streamsize>(uuid.size()));
    file.close();
    if (!file) {
        fail(LMB_ERROR_WRITE, std::string("cannot write: ") + std::strerror(errno));
    }
}

void check_uuid(const std::string &path)
{
    std::ifstream file(path, std::ios::binary);
    std::string stored(kUuidLength, '\0');
    file.seekg(kUuidOffset);
    file.read(&stored[0], static_cast<std::streamsize>(kUuidLength));
    if (!file) {
        fail(LMB_ERROR_FORMAT, "the file is cut short in its header");
    }
    const bool is_ours = stored[14] == '8';
    if (is_ours && stored != content_uuid(file)) {
        fail(LMB_ERROR_FORMAT, "damaged or cut short: the contents do not match their hash");
    }
}

} // namespace lmb_vdb
