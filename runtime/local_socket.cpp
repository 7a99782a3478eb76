#include "runtime/local_socket.hpp"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <system_error>

namespace steadyboom::runtime {

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
    throw std::runtime_error("socket " + path.string() + ": " + what);
}

sockaddr_un address_of(const std::filesystem::path& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.empty() || path.native().size() >= sizeof address.sun_path) {
        fail(path, "the path must have 1 to " + std::to_string(sizeof address.sun_path - 1) + " characters");
    }
    std::memcpy(address.sun_path, path.c_str(), path.native().size());
    return address;
}

bool answers(const sockaddr_un& address) {
    const FileDescriptor probe(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    return connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 || errno == EAGAIN;
}

}  // namespace

FileDescriptor listen_at(const std::filesystem::path& path, std::uint32_t file_mode) {
    const sockaddr_un address = address_of(path);
    const auto* generic = reinterpret_cast<const sockaddr*>(&address);
    FileDescriptor listener(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    int result = bind(listener.get(), generic, sizeof address);
    if (result != 0 && errno == EADDRINUSE) {
        if (answers(address)) {
            fail(path, "another program listens there; stop it, or name another path");
        }
        struct stat facts {};
        if (stat(path.c_str(), &facts) == 0 && !S_ISSOCK(facts.st_mode)) {
            fail(path, "there is a file of another kind; name another path");
        }
        unlink(path.c_str());
        result = bind(listener.get(), generic, sizeof address);
    }
    // Nobody can connect before listen(), so the mode set in between is the first that counts.
    if (result != 0 || chmod(path.c_str(), file_mode) != 0 || listen(listener.get(), 16) != 0) {
        fail(path, "cannot listen: " + std::generic_category().message(errno) +
                       "; make its folder and let this user write there");
    }
    return listener;
}

FileDescriptor connect_to(const std::filesystem::path& path) {
    const sockaddr_un address = address_of(path);
    FileDescriptor connection(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
    if (connect(connection.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
        return {};
    }
    return connection;
}

}  // namespace steadyboom::runtime
