# Thin: every target is one command that can be typed by hand. `make demo` and `make test` are each enough on a fresh machine.
RUNTIME := target/runtime
DEBIAN := g++ pkg-config libopencv-dev libturbojpeg0-dev clang libclang-dev python3 python3-pip
DEBIAN_TEST := chromium ffmpeg mbpoll node-typescript poppler-utils python3-venv systemd

# From OpenCV 4.7 on the marker detector is in another of its modules.
OBJDETECT = $(shell pkg-config --atleast-version=4.7 opencv4 && echo --features andond/objdetect)

.PHONY: setup packages test-packages build demo test test-times lint deny bench stations board-load line chaos power-loss deaf soak modbus-fuzz plc-latency degraded-clips sight deletions unseen deb nspawn debian-13

setup: packages
	python3 daemon/perception/models/provision.py $(RUNTIME)

# No root is needed where the packages are there already.
packages:
	@dpkg -s $(DEBIAN) >/dev/null 2>&1 || tests/setup/apt.sh $(DEBIAN)

test-packages: packages
	@dpkg -s $(DEBIAN_TEST) >/dev/null 2>&1 || tests/setup/apt.sh $(DEBIAN_TEST)
	python3 tests/setup/axe.py target/axe

build: setup
	cargo build --release --locked -p andond -p andon-video $(OBJDETECT)

demo: build
	target/release/andond demo --speed max

# RealSense is on. With and without it the whole workspace is named. Then the dependencies have the same features both times, and only the three
# crates that have this feature are compiled twice.
REALSENSE = --locked --workspace --features andon-video/realsense,andon-realsense/realsense,andon-tests/realsense $(OBJDETECT)

lint:
	cargo fmt --all --check
	cargo clippy $(REALSENSE) --all-targets -- -D warnings
	cargo clippy --locked --workspace --all-targets $(OBJDETECT) -- -D warnings

deny:
	@command -v cargo-deny >/dev/null || CARGO_PROFILE_DEV_DEBUG=0 cargo install --locked --debug cargo-deny
	cargo fetch --locked
	cargo deny --offline --locked check bans licenses sources

# Everything is built and run once, with RealSense; then the one test that needs a build without it. Tests of the line start the
# programs in the target folder, so these are built first. `cargo test` does the same, one program after the other. Tests that work
# by chance draw a seed, which is printed; `ANDON_SEED=n PROPTEST_RNG_SEED=n make test` repeats a draw.
test: setup test-packages lint
	python3 daemon/realsense/provision.py $(RUNTIME) --recorder
	cargo build $(REALSENSE) --all-targets
	tests/setup/side_by_side.py $(TIMES) $(REALSENSE)
	cargo test $(REALSENSE) --doc
	cargo test --locked --workspace $(OBJDETECT) --test camera a_camera_that_this_build_does_not_support

# `make test`, and writes what each of its programs took to tests/TIMES.md.
test-times: TIMES := --times tests/TIMES.md
test-times: test

# Prints one table and writes target/bench/report.json. The Python peers are fetched once, into target/bench/venv.
bench: setup test-packages line
	python3 tests/benches/report.py

# Kills, stops and restarts every role, the recorder and the PLC's program at random. A quiet machine does the 1,000 kills in half an hour.
# Of a hundred roles 99 must be back within 600 ms. SEED=n repeats a run. Writes target/chaos/report.json.
SEED = $(shell shuf -i 1-99999 -n 1)
chaos: line test-packages
	target/release/chaos 1000 $(SEED) target/chaos/report.json 600

# Plays the clips at 30 Hz through 4, 6, 8 and 10 stations at once, and says what share of their frames is seen.
stations: setup line
	tests/benches/stations.py

# What 20 browsers cost that look at a board over TLS, with the picture, and whether the line misses a frame for them.
board-load: setup line
	tests/benches/board.py

# Takes the power from a line 500 times, in the middle of what the journal does to its disk; writes target/power_loss/report.json.
power-loss: line
	target/release/power_loss 500 $(SEED) target/power_loss/report.json

# Plays 2.6 million frames, a day at 30 Hz, at full speed; writes target/soak/report.json.
soak: line
	target/release/soak

line: packages
	cargo build --release --locked -p andond -p andon-video -p andon-tests --bins $(OBJDETECT)

# Judges the shipped clips at fewer frames per second, with noise, in the dark and compressed: no correct one may be accused.
degraded-clips: setup test-packages line
	target/release/degraded_clips tests/footage/p?_*.mp4

# Says what the line tells of pictures that something is done to, how strongly is drawn; SEED=n repeats a run.
sight: setup test-packages line
	target/release/perception_accuracy sight --seed $(SEED) tests/footage/p?_*.mp4

# Deletes observations from correct recordings some 8,000 times, of one piece and of two, with and without an encoder that starts again. Nothing may
# be accused. SEED=n repeats a run; `make test` tries some 400.
deletions: setup test-packages
	cargo build $(REALSENSE) --all-targets
	PROPTEST_RNG_SEED=$(SEED) PROPTEST_CASES=1000 cargo test $(REALSENSE) --test method doubt_properties::
	PROPTEST_RNG_SEED=$(SEED) PROPTEST_CASES=50000 cargo test $(REALSENSE) --test method judge_monotony::
	ANDON_SEED=$(SEED) ANDON_CASES=400 cargo test $(REALSENSE) --test learn_clips --test learn_vmci --test learn_doubt \
		--test learn_two_hands nothing_is_accused

# Every state in which nobody watches leads to no result, and every change of a picture is told; `make test` draws some.
unseen: setup test-packages
	cargo build $(REALSENSE) --all-targets
	ANDON_EVERY=1 cargo test $(REALSENSE) --test line_unseen --test line_sight --test perception_accuracy -- --nocapture

# Lets every connection that a role makes fail once; `make test` lets every seventh.
deaf: setup test-packages
	cargo build $(REALSENSE) --all-targets
	ANDON_EVERY=1 cargo test $(REALSENSE) --test line_deaf -- --nocapture

# Throws random bytes at the Modbus side for 10 minutes; writes target/modbus_fuzz/report.json.
modbus-fuzz: line
	target/release/modbus_fuzz

# From a verdict to the PLC's register and to a C program; writes target/plc_latency/report.json.
plc-latency: line
	cargo build --release --locked -p andon-plc
	target/release/plc_latency

# One Debian package with all that a cell controller needs, in target/deb; RealSense is on in it. With FORM=--short it holds the programs
# that `make test` has built, so that nothing is compiled twice: such a package is for tests alone.
DEBIAN_DEB := dpkg-dev lintian
ifeq ($(FORM),--short)
PROGRAMS := target/debug
BUILD_PROGRAMS = cargo build $(REALSENSE) --all-targets
COMPRESSION := --fast
else
PROGRAMS := target/release
BUILD_PROGRAMS = cargo build --release --locked -p andond -p andon-video -p andon-plc --features andon-video/realsense $(OBJDETECT)
endif
deb: setup
	@dpkg -s $(DEBIAN_DEB) >/dev/null 2>&1 || tests/setup/apt.sh $(DEBIAN_DEB)
	@command -v cargo-deb >/dev/null || CARGO_PROFILE_DEV_DEBUG=0 CARGO_PROFILE_DEV_OPT_LEVEL=1 cargo install --locked --debug cargo-deb
	python3 daemon/realsense/provision.py $(RUNTIME)
	$(BUILD_PROGRAMS)
	rm -rf target/deb && mkdir -p target/deb
	$(PROGRAMS)/andond man target/deb/man
	for shell in bash fish zsh; do $(PROGRAMS)/andond completions $$shell > target/deb/completions.$$shell || exit 1; done
	strip -o target/deb/andond $(PROGRAMS)/andond
	strip -o target/deb/andond-video $(PROGRAMS)/andond-video
	strip --strip-unneeded -o target/deb/libandon_plc.so.0 $(PROGRAMS)/libandon_plc.so
	ln -s libandon_plc.so.0 target/deb/libandon_plc.so
	cargo deb --no-build --no-strip $(COMPRESSION) -p andond --output target/deb/
	lintian --fail-on error target/deb/*.deb

# The package for Debian 13 and its check, both in containers of their own; in target/debian-13. Continuous integration does not run it.
debian-13:
	@dpkg -s $(DEBIAN_NSPAWN) >/dev/null 2>&1 || tests/setup/apt.sh $(DEBIAN_NSPAWN)
	python3 tests/nspawn/build.py trixie target/debian-13 $(FORM)
	python3 tests/nspawn/nspawn.py $(FORM) --release trixie target/debian-13/target/deb/*.deb target/debian-13/nspawn

# Installs the package on a bare Debian in a container, boots it and checks it there; writes target/nspawn/report.json.
# FORM=--short is what continuous integration runs.
DEBIAN_NSPAWN := debootstrap systemd-container
nspawn: deb
	@dpkg -s $(DEBIAN_NSPAWN) >/dev/null 2>&1 || tests/setup/apt.sh $(DEBIAN_NSPAWN)
	python3 tests/nspawn/nspawn.py $(FORM) target/deb/*.deb target/nspawn
