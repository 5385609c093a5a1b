# Thin: every target is one command that can be typed by hand. `make demo` and `make test` are each enough on a fresh machine.
RUNTIME := target/runtime
DEBIAN := g++ pkg-config libopencv-dev clang libclang-dev python3 python3-pip
DEBIAN_TEST := mbpoll python3-venv

.PHONY: setup packages test-packages build demo test lint deny bench

setup: packages
	python3 daemon/perception/models/provision.py $(RUNTIME)

# No root is needed where the packages are there already.
packages:
	@dpkg -s $(DEBIAN) >/dev/null 2>&1 || tests/setup/apt.sh $(DEBIAN)

test-packages: packages
	@dpkg -s $(DEBIAN_TEST) >/dev/null 2>&1 || tests/setup/apt.sh $(DEBIAN_TEST)

build: setup
	cargo build --release --locked -p andond

demo: build
	target/release/andond demo

lint:
	cargo fmt --all --check
	cargo clippy --workspace --all-targets --locked -- -D warnings

deny:
	@command -v cargo-deny >/dev/null || cargo install --locked cargo-deny
	cargo fetch --locked
	cargo deny --offline --locked check bans licenses sources

test: setup test-packages lint
	cargo build --locked --workspace --bins
	cargo test --locked --workspace

# Prints one table and writes target/bench/report.json. The Python peers are fetched once, into target/bench/venv.
bench: test-packages
	python3 tests/benches/report.py

# Kills, stops and restarts every role at random, 1,000 kills; writes target/chaos/report.json.
chaos: line
	target/release/chaos

# Plays 2.6 million frames, a day at 30 Hz, at full speed; writes target/soak/report.json.
soak: line
	target/release/soak

.PHONY: line chaos soak
line: packages
	cargo build --release --locked -p andond -p andon-tests --bins
