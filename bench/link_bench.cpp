// SPDX-License-Identifier: Apache-2.0
// How fast the link carries a scene to a server over loopback, by size of frame and by loss: the
// real sessions and sockets, an engine that does nothing, datagrams dropped by dice as they come
// in.
//
//   fasttree_link_bench [MEGABYTES [ROUNDS]]
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <thread>
#include <vector>

#include "device/link/byte_source.h"
#include "device/link/client_session.h"
#include "device/link/server_session.h"
#include "device/net/udp_port.h"

namespace fasttree::device {
namespace {

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Drops datagrams by dice.
class Dice {
 public:
  Dice(double chance, std::uint64_t seed)
      : threshold_(static_cast<std::uint64_t>(chance * 4294967296.0)), random_(seed) {}
  bool drop() { return threshold_ > 0 && (random_() & 0xFFFFFFFF) < threshold_; }

 private:
  std::uint64_t threshold_;
  std::mt19937_64 random_;
};

/// One side: takes in, thinks, sends out, waits; until told to stop.
template <typename Session, typename Think, typename Stop>
void drive(UdpPort& port, Session& session, Dice& dice, Think think, Stop stop) {
  Outbox out;
  while (!stop()) {
    const std::size_t received =
        port.receive([&](std::span<const std::byte> datagram, const Peer& from) {
          if (!dice.drop()) session.on_datagram(datagram, from, micros_now());
        });
    think();
    out.clear();
    const bool more = session.poll(micros_now(), out);
    port.send(out);
    if (received > 0 || more) continue;
    const Micros now = micros_now(), next = std::min(session.next_event(), now + 20'000);
    if (next > now) port.wait(next - now);
  }
}

struct Figures {
  double seconds = 0;
  double client_cpu = 0, server_cpu = 0;
  std::uint64_t frames = 0, again = 0, timeouts = 0;
  bool ok = false;
};

Figures measure(const ByteSource& scene, std::uint32_t payload, double loss) {
  UdpPort server_port = UdpPort::listen({"127.0.0.1", 0}).value();
  UdpPort client_port = UdpPort::connect(server_port.address()).value();
  ServerSettings settings;
  settings.description.most_scene_bytes = ~std::uint64_t{0};
  settings.window_bytes = server_port.receive_buffer_bytes() / 2;
  ServerSession server(settings);
  std::atomic<bool> stop{false};
  Figures figures;
  std::thread thread([&] {
    Dice dice(loss, 1);
    const double before = cpu_seconds();
    drive(
        server_port, server, dice,
        [&] {
          if (server.take_scene()) server.engine_ended(Outcome(), micros_now());
        },
        [&] { return stop.load(); });
    figures.server_cpu = cpu_seconds() - before;
  });
  ClientSettings client_settings;
  client_settings.payload = payload;
  Dice dice(loss, 2);
  const double before = cpu_seconds();
  const auto start = std::chrono::steady_clock::now();
  ClientSession client(client_settings, random_session(), Order(), scene, client_port.peer(),
                       micros_now());
  drive(
      client_port, client, dice, [] {}, [&] { return client.ended(); });
  figures.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  figures.client_cpu = cpu_seconds() - before;
  stop = true;
  server_port.wake();
  thread.join();
  figures.ok = client.status().ok();
  figures.frames = client.counts().frames_sent;
  figures.again = client.counts().retransmitted;
  figures.timeouts = client.counts().timeouts;
  if (!figures.ok) std::fprintf(stderr, "%s\n", client.status().message().c_str());
  return figures;
}

int run(std::uint64_t megabytes, int rounds) {
  std::vector<float> coordinates(megabytes * 1'000'000 / kTriangleBytes * 9);
  std::mt19937 random(1);
  for (float& c : coordinates) c = static_cast<float>(random());
  const PartsSource scene({std::as_bytes(std::span(coordinates))});
  const double bytes = static_cast<double>(scene.size());
  std::printf("%.0f MB of scene, median of %d\n", bytes / 1e6, rounds);
  std::printf("%8s %8s %10s %8s %8s %10s %9s %9s\n", "payload", "loss", "GB/s", "client", "server",
              "frames", "again", "timeouts");
  bool ok = measure(scene, kEthernetPayload, 0).ok;  // memory is touched for the first time
  for (const std::uint32_t payload : {kEthernetPayload, kJumboPayload, kLargestPayload}) {
    for (const double loss : {0.0, 0.001, 0.01, 0.05, 0.1}) {
      std::vector<Figures> all;
      for (int round = 0; round < rounds; ++round) all.push_back(measure(scene, payload, loss));
      std::sort(all.begin(), all.end(),
                [](const Figures& a, const Figures& b) { return a.seconds < b.seconds; });
      const Figures& f = all[all.size() / 2];
      ok = ok && f.ok;
      std::printf("%8u %7.1f%% %10.3f %7.2fs %7.2fs %10llu %9llu %9llu\n", payload, 100 * loss,
                  bytes / f.seconds / 1e9, f.client_cpu, f.server_cpu,
                  static_cast<unsigned long long>(f.frames),
                  static_cast<unsigned long long>(f.again),
                  static_cast<unsigned long long>(f.timeouts));
      std::fflush(stdout);
    }
  }
  return ok ? 0 : 1;
}

}  // namespace
}  // namespace fasttree::device

int main(int argc, char** argv) {
  const std::uint64_t megabytes = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 500;
  const int rounds = argc > 2 ? std::atoi(argv[2]) : 3;
  return fasttree::device::run(std::max<std::uint64_t>(megabytes, 1), std::max(rounds, 1));
}
