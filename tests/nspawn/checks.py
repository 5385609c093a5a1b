"""What an administrator, a technician and a PLC expect of the installed package, one sentence per check.

Each takes the running machine and `seen`, where it leaves the figures for the report. They run in this order.
"""

import json
import re
import subprocess
import time
from pathlib import Path

STATION = "film"
ROLES = ["steward", "capture", "perceive", "encode", "judge", "journal", "plc", "metrics", "record", "board", "executor"]
CONFIG = ["-c", "/etc/andon/andon.toml", "-c", f"/etc/andon/stations/{STATION}.toml"]
TARGET = f"andon@{STATION}.target"
# Greatest exposure of a unit, on systemd's scale from 0 (safe) to 10.
EXPOSURE = 0.9
# Of the units whose watchdog is another one than that of all, in seconds.
WATCHDOG_S = {"record": 60, "executor": 60}
# Where the rest of the system keeps its own records.
NOT_OURS = ("proc/", "sys/", "dev/", "run/", "tmp/", "var/tmp/", "var/log/", "var/cache/", "etc/.pwd.lock")
NOT_OURS += ("var/lib/dpkg/", "var/lib/apt/", "var/lib/systemd/")


def unit(role, station=STATION):
    return f"andon-{role}@{station}.service"


def the_package_installs_and_starts_no_station(machine, seen):
    seen["files_before"] = files(machine)
    machine.must("apt-get", "install", "-y", "-qq", "/mnt/andon.deb", timeout=300)
    assert machine.must("stat", "-c", "%U %a", "/run/andon").strip() == "andon 700"
    assert not running_units(machine), running_units(machine)
    assert machine.must("systemctl", "is-enabled", "andon.target").strip() == "enabled"
    for program in ("andond", "andond-video"):
        assert "not found" not in machine.must("ldd", f"/usr/bin/{program}")
    seen["version"] = machine.must("andond", "--version").split()[1]


def the_demo_judges_the_clips_of_the_package_for_any_user(machine, seen):
    demo = "cd /tmp && andond demo --speed max"
    shown = machine.must("bash", "-c", demo, user="nobody", timeout=600)
    table = shown[shown.index("clip "):].splitlines()
    assert [row.split()[3] for row in table[1:4]] == ["yes"] * 3, shown
    assert "All is as it should be: 3 of 3 clips judged rightly" in shown, shown
    assert re.search(r"^ +/usr/share/doc/andon/", shown, re.M), shown


def a_station_starts_and_every_unit_becomes_active(machine, seen):
    began = time.monotonic()
    machine.must("systemctl", "start", TARGET)
    seen["station_start_s"] = round(time.monotonic() - began, 1)
    for role in ROLES:
        shown = machine.unit(unit(role))
        assert (shown["ActiveState"], shown["Type"]) == ("active", "notify"), f"{role}: {shown['ActiveState']}"
        assert shown["User"] == "andon" and shown["NRestarts"] == "0", f"{role} has restarted"


def verdicts_come_and_the_station_says_that_it_is_healthy(machine, seen):
    tail = " ".join(["timeout 60 andond tail --json", *CONFIG, "| head -n 3"])
    heard = [json.loads(line) for line in machine.must("bash", "-c", tail, user="andon").splitlines()]
    assert len(heard) == 3, heard
    # Where the machine is busy, the line may see too little for a while, and says so.
    status = lambda: json.loads(machine.run("andond", "status", "--json", *CONFIG, user="andon").stdout)
    until(lambda: status()["healthy"], "the station is not healthy", 60)
    until(lambda: rows(machine) >= 3, "the journal has no verdicts", 20)


def nobody_but_the_user_of_the_units_joins_and_others_are_told_who_may(machine, seen):
    # Root would hear nothing, and leave files that the steward may not remove.
    for user in (None, "nobody"):
        done = machine.run("andond", "status", *CONFIG, user=user)
        assert done.returncode == 70 and "sudo -u andon" in done.stderr, done.stderr or done.stdout


def a_camera_that_is_not_attached_is_asked_for_by_name(machine, seen):
    # The library of the RealSense is the package's own: it loads in the unit, locked down as it is.
    film = (machine.root / f"etc/andon/stations/{STATION}.toml").read_text()
    changed = film.replace(f'name = "{STATION}"', 'name = "depth"').replace('source = "video"', 'source = "realsense"')
    station = machine.root / "etc/andon/stations/depth.toml"
    station.write_text(re.sub("^(path|loop) = .*\n", "", changed, flags=re.MULTILINE))
    try:
        machine.must("systemctl", "start", "--no-block", unit("capture", "depth"))
        said = lambda: " ".join(str(entry["MESSAGE"]) for entry in machine.journal("--unit", unit("capture", "depth")))
        until(lambda: "no RealSense camera is attached" in said(), "nothing is said of the camera", 20)
    finally:
        station.unlink()
        machine.run("systemctl", "stop", unit("capture", "depth"), unit("steward", "depth"))


def a_plc_reads_the_status_word_and_a_c_program_the_verdicts(machine, seen):
    # Function 3, register 0, one of it; bit 0 is online, bit 1 ready.
    ask = "exec 3<>/dev/tcp/127.0.0.1/1502; printf '\\0\\1\\0\\0\\0\\6\\1\\3\\0\\0\\0\\1' >&3; head -c 11 <&3 | od -An -tx1"
    answer = lambda: [int(byte, 16) for byte in machine.must("bash", "-c", ask).split()]
    until(lambda: len(answer()) == 11 and answer()[10] & 3 == 3, "the line is not online and ready", 60)
    program = machine.root / "usr/local/bin/soft_plc"
    example = machine.root / "usr/share/doc/andon/examples/soft_plc.c"
    library = machine.root / "usr/lib/x86_64-linux-gnu"
    build = ["cc", "-std=c11", f"-I{machine.root}/usr/include", example, f"-L{library}", "-landon_plc", "-o", program]
    # The machine may have a newer C library than this one.
    build.append("-Wl,--allow-shlib-undefined")
    subprocess.run(build, check=True)
    try:
        heard = machine.must("/usr/local/bin/soft_plc", STATION, "2", user="andon")
    finally:
        program.unlink()
    assert "received 2 lost 0" in heard, heard


def the_log_has_its_code_role_and_station_in_fields(machine, seen):
    for role in ROLES:
        entries = [entry for entry in machine.journal("--unit", unit(role)) if "ANDON_CODE" in entry]
        assert entries, f"{role} logs without a code"
        assert all(entry["ANDON_ROLE"] == role and entry["ANDON_STATION"] == STATION for entry in entries), entries[0]
        assert all(re.fullmatch(r"AND-\d{3}", entry["ANDON_CODE"]) for entry in entries), entries[0]


def no_unit_is_more_exposed_than_0_9(machine, seen):
    listed = machine.must("systemd-analyze", "security", "--no-pager", "--json=short")
    levels = {row["unit"]: float(row["exposure"]) for row in json.loads(listed)}
    seen["exposure"] = {role: levels[unit(role)] for role in ROLES}
    assert max(seen["exposure"].values()) <= EXPOSURE, seen["exposure"]


def the_executor_may_write_in_the_folder_of_its_state_and_nowhere_else(machine, seen):
    pid = machine.unit(unit("executor"))["MainPID"]
    # As the unit sees the disk; `test -w` asks the system, which knows what is mounted to be read only.
    asked = ["nsenter", f"--target={pid}", "--mount", "runuser", "-u", "andon", "--", "test", "-w"]
    assert machine.run(*asked, "/var/lib/andon").returncode == 0
    # Root may write everywhere but where nobody may.
    for folder in ("/etc/andon", "/etc/andon/stations", "/usr/share/andon"):
        assert machine.run(*asked[:3], *asked[-2:], folder).returncode == 1, f"{folder} can be written"


def a_role_that_stands_still_is_ended_by_the_watchdog_and_comes_back(machine, seen):
    seen["watchdog_s"] = {}
    for role in seen["stopped_roles"]:
        began = time.monotonic()
        before = machine.unit(unit(role))
        machine.must("systemctl", "kill", "--kill-whom=main", "--signal=STOP", unit(role))
        is_ended = lambda: machine.unit(unit(role))["NRestarts"] != before["NRestarts"]
        until(is_ended, f"{role} is not ended", WATCHDOG_S.get(role, 5) + 25)
        seen["watchdog_s"][role] = round(time.monotonic() - began, 1)
        until(lambda: all_active(machine), f"{role} does not come back", 30)
        verdicts_go_on(machine)


def a_role_that_is_killed_comes_back_and_verdicts_go_on(machine, seen):
    for role in ROLES:
        before = machine.unit(unit(role))
        machine.must("systemctl", "kill", "--kill-whom=main", "--signal=KILL", unit(role))
        until(lambda: machine.unit(unit(role))["NRestarts"] != before["NRestarts"], f"{role} is not started again", 20)
        until(lambda: all_active(machine), f"{role} does not come back", 30)
    verdicts_go_on(machine)


def every_thread_of_a_role_has_the_cores_and_the_priority_that_its_unit_is_given(machine, seen):
    folder = f"/run/systemd/system/{unit('perceive')}.d"
    settings = "[Service]\\nCPUAffinity=0\\nNice=-5\\n"
    machine.must("bash", "-c", f"mkdir -p {folder} && printf '{settings}' > {folder}/cores.conf && systemctl daemon-reload")
    machine.must("systemctl", "restart", unit("perceive"))
    until(lambda: all_active(machine), "the line does not come back", 30)
    verdicts_go_on(machine)
    pid = machine.unit(unit("perceive"))["MainPID"]
    cores = machine.must("bash", "-c", f"grep -h Cpus_allowed_list /proc/{pid}/task/*/status").split()[1::2]
    # The nineteenth number (proc_pid_stat(5)): no thread has a blank in its name.
    nice = machine.must("bash", "-c", f"awk '{{print $19}}' /proc/{pid}/task/*/stat").split()
    assert len(cores) > 2 and set(cores) == {"0"} and set(nice) == {"-5"}, (cores, nice)
    machine.must("bash", "-c", f"rm -r {folder} && systemctl daemon-reload")
    machine.must("systemctl", "restart", unit("perceive"))
    until(lambda: all_active(machine), "the line does not come back", 30)


def a_recorder_that_runs_only_where_nothing_else_has_to_leaves_recordings_that_open(machine, seen):
    station = machine.root / f"etc/andon/stations/{STATION}.toml"
    before = station.read_text()
    station.write_text(before + '\n[record]\nmode = "always"\n')
    try:
        # A line goes on with what it has started with until its target is started again.
        machine.must("systemctl", "restart", TARGET)
        until(lambda: all_active(machine), "the line does not come back", 30)
        pid = machine.unit(unit("record"))["MainPID"]
        # The forty-first number (proc_pid_stat(5)): 5 is SCHED_IDLE.
        policies = machine.must("bash", "-c", f"awk '{{print $41}}' /proc/{pid}/task/*/stat").split()
        assert len(policies) > 1 and set(policies) == {"5"}, policies
        # On a busy machine such a recorder may begin after the first verdicts. The index beside a recording names those that it has.
        has_verdict = ["bash", "-c", f"grep -q decided_utc_ns /var/lib/andon/{STATION}.recordings/*.json"]
        until(lambda: machine.run(*has_verdict, user="andon").returncode == 0, "no verdict is recorded", 60)
    finally:
        station.write_text(before)
        machine.must("systemctl", "restart", TARGET)
    until(lambda: all_active(machine), "the line does not come back", 30)
    recordings = machine.must("bash", "-c", f"ls /var/lib/andon/{STATION}.recordings/*.mcap", user="andon").split()
    shown = machine.run("andond", "replay", recordings[0], user="andon")
    equal = re.search(r"^as recorded: (\d+) of [1-9].*", shown.stderr, re.M)
    assert shown.returncode < 3 and equal, shown.stderr
    seen["recorded"] = equal.group()


def stopping_the_station_leaves_no_process_and_no_shared_memory(machine, seen):
    began = time.monotonic()
    machine.must("systemctl", "stop", TARGET)
    until(lambda: not running_units(machine), "units go on", 20)
    seen["station_stop_s"] = round(time.monotonic() - began, 1)
    for role in ROLES:
        shown = machine.unit(unit(role))
        assert (shown["Result"], shown["ExecMainStatus"]) == ("success", "0"), f"{role}: {shown['Result']} {shown['ExecMainStatus']}"
    assert not processes(machine), processes(machine)
    assert machine.must("ls", "/dev/shm") == "", machine.must("ls", "/dev/shm")


def a_bad_configuration_ends_with_78_names_its_place_and_is_not_tried_again(machine, seen):
    station = machine.root / "etc/andon/stations/bad.toml"
    station.write_text('[station]\nname = "bad"\n\n[camera]\nsorce = "video"\n')
    try:
        machine.run("systemctl", "start", unit("judge", "bad"))
        # Restarts come after 100 ms.
        time.sleep(1)
        shown = machine.unit(unit("judge", "bad"))
        assert (shown["ActiveState"], shown["ExecMainStatus"], shown["NRestarts"]) == ("failed", "78", "0"), shown
        words = " ".join(str(entry["MESSAGE"]) for entry in machine.journal("--unit", unit("judge", "bad")))
        assert "bad.toml:5" in words and "source" in words, words
    finally:
        station.unlink()
        machine.run("systemctl", "stop", unit("judge", "bad"), unit("steward", "bad"))
        machine.run("systemctl", "reset-failed")


def one_command_installs_a_station_whose_board_an_engineer_may_enter(machine, seen):
    machine.must("andond", "new", "bench9", "--part", "brick", "--board=9470", "--out", "/run/bench9.toml")
    said = machine.must("andond", "install", "/run/bench9.toml", "--engineer", "eva", stdin="correct horse battery staple\n")
    try:
        assert "http://localhost:9470/engineer" in said, said
        until(lambda: machine.unit(unit("board", "bench9"))["ActiveState"] == "active", "its board does not start", 60)
        config = ["-c", "/etc/andon/andon.toml", "-c", "/etc/andon/stations/bench9.toml"]
        logins = machine.must("andond", "board", "logins", *config, user="andon")
        assert logins.split() == ["eva", "engineer"], logins
    finally:
        machine.run("systemctl", "disable", "andon@bench9.target")
        machine.run("systemctl", "stop", "andon@bench9.target", *[unit(role, "bench9") for role in ROLES])
        (machine.root / "etc/andon/stations/bench9.toml").unlink(missing_ok=True)


def a_library_that_was_upgraded_interrupts_no_station(machine, seen):
    machine.must("systemctl", "start", TARGET)
    until(lambda: all_active(machine), "the station does not come up", 30)
    # As an upgrade does it: another file under the same name. needrestart then finds every process that has the old one.
    library = machine.must("bash", "-c", "ldd /usr/bin/andond | sed -n 's/.*=> \\(.*libstdc[^ ]*\\) .*/\\1/p'").strip()
    machine.must("bash", "-c", f"cp $(realpath {library}) /mnt/library && mv /mnt/library $(realpath {library})")
    before = {role: machine.unit(unit(role))["MainPID"] for role in ROLES}
    found = machine.must("needrestart", "-b", "-r", "l")
    assert unit("judge") in found, found
    machine.must("needrestart", "-q", "-r", "a")
    after = {role: machine.unit(unit(role))["MainPID"] for role in ROLES}
    assert after == before, f"restarted: {before} {after}"


def an_upgrade_keeps_what_was_changed_and_the_line_comes_back(machine, seen):
    config = machine.root / "etc/andon/andon.toml"
    changed = config.read_text() + "\n# changed by an administrator\n"
    config.write_text(changed)
    machine.must("systemctl", "start", TARGET)
    for package in ("andon.deb", "newer.deb"):
        before = {role: machine.unit(unit(role))["MainPID"] for role in ROLES}
        install = ["apt-get", "install", "-y", "-qq", "--reinstall", "-o", "Dpkg::Options::=--force-confold", f"/mnt/{package}"]
        machine.must(*install, timeout=300)
        assert config.read_text() == changed, f"{package} has overwritten the configuration"
        restarted = lambda: all_active(machine) and all(machine.unit(unit(role))["MainPID"] != before[role] for role in ROLES)
        until(restarted, f"the line does not come back after {package}", 120)
        verdicts_go_on(machine)
        # It has waited for the end of the job that ran.
        last, after = around_the_newest_restart_of_the_judge(machine)
        assert last == "job", f"the newest verdict before the restart is of the level {last}, the one after it of {after}"
    assert machine.must("dpkg-query", "-W", "-f", "${Version}", "andon") == seen["newer"]


def an_enabled_station_comes_back_after_a_reboot(machine, seen):
    machine.must("systemctl", "enable", TARGET)
    assert machine.power_off(), "the machine does not go down"
    machine.boot()
    until(lambda: all_active(machine), "the station does not come up", 60)
    verdicts_go_on(machine)


def removal_keeps_configuration_and_verdicts_and_purge_leaves_nothing(machine, seen):
    # The first is not the package's own, as a job that was taught here is not.
    kept = ["etc/andon/stations/own.toml", "etc/andon/andon.toml", f"var/lib/andon/{STATION}.sqlite"]
    (machine.root / kept[0]).write_text("# a station of the administrator's\n")
    machine.must("apt-get", "remove", "-y", "-qq", "andon")
    assert not running_units(machine)
    assert not processes(machine), processes(machine)
    assert machine.run("test", "-e", "/run/andon").returncode != 0
    assert all((machine.root / path).exists() for path in kept), f"removal has taken one of {kept}"
    machine.must("apt-get", "purge", "-y", "-qq", "andon")
    left = sorted(files(machine) - seen.pop("files_before"))
    assert not left, left
    assert "andon" not in machine.must("getent", "passwd")


CHECKS = [
    the_package_installs_and_starts_no_station,
    the_demo_judges_the_clips_of_the_package_for_any_user,
    a_station_starts_and_every_unit_becomes_active,
    verdicts_come_and_the_station_says_that_it_is_healthy,
    nobody_but_the_user_of_the_units_joins_and_others_are_told_who_may,
    a_camera_that_is_not_attached_is_asked_for_by_name,
    a_plc_reads_the_status_word_and_a_c_program_the_verdicts,
    the_log_has_its_code_role_and_station_in_fields,
    no_unit_is_more_exposed_than_0_9,
    the_executor_may_write_in_the_folder_of_its_state_and_nowhere_else,
    a_role_that_stands_still_is_ended_by_the_watchdog_and_comes_back,
    a_role_that_is_killed_comes_back_and_verdicts_go_on,
    every_thread_of_a_role_has_the_cores_and_the_priority_that_its_unit_is_given,
    a_recorder_that_runs_only_where_nothing_else_has_to_leaves_recordings_that_open,
    stopping_the_station_leaves_no_process_and_no_shared_memory,
    a_bad_configuration_ends_with_78_names_its_place_and_is_not_tried_again,
    one_command_installs_a_station_whose_board_an_engineer_may_enter,
    a_library_that_was_upgraded_interrupts_no_station,
    an_upgrade_keeps_what_was_changed_and_the_line_comes_back,
    an_enabled_station_comes_back_after_a_reboot,
    removal_keeps_configuration_and_verdicts_and_purge_leaves_nothing,
]


def andond(machine, *arguments):
    return machine.must("andond", *arguments, *CONFIG, user="andon")


def rows(machine):
    """How many verdicts and gaps the journal has."""
    return len(andond(machine, "history", "--csv").splitlines()) - 1


def around_the_newest_restart_of_the_judge(machine):
    """The levels of the verdicts before and after it."""
    header, *lines = andond(machine, "history", "--csv").splitlines()
    shown = [dict(zip(header.split(","), line.split(","))) for line in lines]
    verdicts = [row for row in shown if row["entry"] == "verdict"]
    newest = max(n for n in range(1, len(verdicts)) if verdicts[n]["epoch"] != verdicts[n - 1]["epoch"])
    return verdicts[newest - 1]["level"], verdicts[newest]["level"]


def verdicts_go_on(machine):
    before = rows(machine)
    until(lambda: rows(machine) > before, "no verdict comes", 60)


def running_units(machine):
    listed = machine.must("systemctl", "list-units", "--no-legend", "--plain", "--state=active,activating,reloading,deactivating", "andon-*@*")
    return [line.split()[0] for line in listed.splitlines()]


def all_active(machine):
    return all(machine.unit(unit(role))["ActiveState"] == "active" for role in ROLES)


def processes(machine):
    """Those of the user of all roles."""
    return machine.run("find", "/proc", "-maxdepth", "1", "-user", "andon").stdout.split()


def until(is_so, complaint, seconds):
    end = time.monotonic() + seconds
    while not is_so():
        assert time.monotonic() < end, f"{complaint} within {seconds} s"
        time.sleep(0.2)


def files(machine):
    """Every file of the machine that is not a record of the system itself."""
    listed = machine.must("find", "/", "-xdev", "-printf", "%P\\n").splitlines()
    return {path for path in listed if not path.startswith(NOT_OURS)}
