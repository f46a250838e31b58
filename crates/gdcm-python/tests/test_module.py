"""The module compared with the commands of the same program, and as a Python package."""

import inspect
import json
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from functools import lru_cache
from pathlib import Path
from typing import Any, List
from unittest import mock

import numpy as np

import gdcm
from gdcm import _gdcm

OMEGA = np.geomspace(0.5, 12.0, 50)


def command(*words: Any, environment: Any = None) -> subprocess.CompletedProcess:
    """Run the script `gdcm`, which the wheel puts on the path."""
    return subprocess.run(
        ["gdcm", *map(str, words)], capture_output=True, text=True, env=environment, check=False
    )


def without_source(corrections: dict) -> dict:
    """Return corrections without the checksum of the dataset file and the provenance of models."""
    corrections = json.loads(json.dumps(corrections))
    del corrections["dataset"]["sha256"]
    for condition in corrections["conditions"]:
        condition.pop("sources", None)
    return corrections


@lru_cache(maxsize=None)
def example() -> gdcm.Dataset:
    return gdcm.example()


@lru_cache(maxsize=None)
def with_leads() -> gdcm.Analysis:
    return gdcm.analyze(example(), phase="lead", reject="suggested")


@lru_cache(maxsize=None)
def with_delays() -> gdcm.Analysis:
    return gdcm.analyze(example())


@lru_cache(maxsize=None)
def records() -> List[Path]:
    """Return the example records of condition 10 in which LON is swept."""
    folder = tempfile.mkdtemp()
    unittest.addModuleCleanup(lambda: subprocess.run(["rm", "-r", folder], check=True))
    found = gdcm.example_records(folder, condition=10)
    return [file for file in found if "LON" in file.name]


@lru_cache(maxsize=None)
def identified() -> gdcm.Identification:
    return gdcm.identify(records(), inputs=["LON [%]"], outputs=["Q [deg/s]"], band=(0.5, 12.0))


class Folder(unittest.TestCase):
    """Base class of tests that use an empty folder."""

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)


class Agreement(Folder):
    """Numbers equal those of the command, to the last digit."""

    def corrections(self, *words: Any) -> dict:
        """Return ``corrections.json`` of the command ``analyze``."""
        done = command("analyze", *words, "--out", self.folder / "results", "--force")
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads((self.folder / "results" / "corrections.json").read_text())

    def test_results_are_those_of_analyze(self) -> None:
        fix = with_leads()
        self.assertEqual(
            fix.corrections, self.corrections("--phase", "lead", "--reject-suggested")
        )
        row = next(
            row
            for row in fix[10].contents["net_gains"]
            if (row["output"], row["input"]) == ("Q", "LON")
        )
        self.assertEqual(fix[10].net_gain["Q", "LON"], row["gain"])
        self.assertEqual(list(fix[10].net_gain_interval["Q", "LON"]), row["interval"])
        lowest, highest = fix[10].net_gain_interval["Q", "LON"]
        self.assertTrue(lowest < fix[10].net_gain["Q", "LON"] < highest)
        place = (fix.outputs.index("Q"), fix.inputs.index("LON"))
        self.assertEqual(fix[10].net_gain.array[place], row["gain"])
        self.assertEqual(tuple(fix[10].net_gain_interval.array[place]), tuple(row["interval"]))
        product = fix[10].gains["Q"] * fix[10].gains["LON"]
        self.assertAlmostEqual(product, row["gain"], places=14)
        self.assertEqual(fix[10].G[place], fix[10].contents["G"][place[0]][place[1]])
        leads = fix[10].contents["lead"]
        self.assertEqual(
            fix[10].net_delay_s["Q", "LON"],
            leads["outputs"]["Q"]["tau_s"] + leads["inputs"]["LON"]["tau_s"],
        )

    def test_settings_are_those_of_analyze(self) -> None:
        fix = gdcm.analyze(
            example(),
            band=(0.6, 10),
            points=60,
            gain_bounds=(0.8, 1.25),
            delay_bound=np.float64(0.03),
            degree="table",
            schedule_delays="always",
            half_overlap=True,
            reject=[(3, "V+5kt"), "1:V-5kt"],
            on=[("Q", "LON"), ("P", "LAT")],
            hold_out=[4, 5],
            sign={"NZ": -1},
            level=0.95,
        )
        expected = self.corrections(
            *("--band", 0.6, 10, "--points", 60, "--gain-bounds", 0.8, 1.25),
            *("--delay-bound", 0.03, "--degree", "table", "--schedule-delays=always"),
            *("--half-overlap", "--reject", "3:V+5kt", "--reject", "1:V-5kt"),
            *("--on", "Q/LON,P/LAT", "--hold-out", "4,5", "--sign", "NZ=-1", "--level", 0.95),
        )
        self.assertEqual(fix.corrections, expected)
        self.assertEqual(fix.settings["band_rad_s"], [0.6, 10.0])
        self.assertEqual(fix[3].rejected, ["V+5kt"])
        self.assertIsNone(fix.schedule.degree)

    def test_the_schedule_at_its_airspeeds_is_its_table(self) -> None:
        schedule = with_leads().schedule
        for row in schedule.contents["table"]:
            found = schedule.at(airspeed_kt=row["airspeed_kt"])
            self.assertEqual(found.gains.inputs, row["inputs"])
            self.assertEqual(found.gains.outputs, row["outputs"])
            assert found.leads is not None
            self.assertEqual(found.leads.inputs, row["lead"]["inputs"])
        with self.assertRaises(ValueError):
            schedule.at(75, mass_kg=7000)

    def test_the_second_variable_of_the_schedule_is_used(self) -> None:
        schedule = gdcm.analyze(example(), second_variable="mass").schedule
        term = schedule.contents["second_variable"]
        light, heavy = (
            schedule.at(80, mass_kg=term["middle"] + sign * term["half_range"]).gains["LON"]
            for sign in (-1.0, 1.0)
        )
        # The logarithm of a gain is linear in the second variable, from -1 to 1 over its range.
        self.assertAlmostEqual(np.log(heavy / light), 2 * term["inputs"]["LON"], places=12)
        middle = schedule.at(80, mass_kg=term["middle"]).gains["LON"]
        self.assertEqual(schedule.at(80).gains["LON"], middle)

    def test_summary_and_cautions_are_those_of_analyze(self) -> None:
        done = command(
            *("analyze", "--json", "--phase", "lead", "--reject-suggested", "--out", self.folder)
        )
        messages = json.loads(done.stdout)
        fix = with_leads()
        # Only the beginning is compared: the command goes on to name its output files.
        self.assertTrue(messages["text"].startswith(fix.summary[:2000]))
        codes = [caution["code"] for caution in messages["cautions"]]
        self.assertEqual([caution.code for caution in fix.cautions], codes)
        self.assertTrue(codes)

    def test_identified_models_are_those_of_identify(self) -> None:
        done = command(
            *("identify", *records(), "--inputs", "LON [%]", "--outputs", "Q [deg/s]"),
            *("--band", 0.5, 12, "--out", self.folder),
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        expected = json.loads((self.folder / "identified.json").read_text())
        found = identified()
        self.assertEqual(found.contents, expected)
        self.assertEqual(found.order, expected["models"][0]["order"])
        self.assertEqual(found.model.A.shape, (found.order, found.order))
        self.assertEqual(found.chi2_dof, expected["validation"]["fit_per_dof"])
        self.assertEqual(
            [caution.code for caution in found.cautions],
            [caution["code"] for caution in expected["cautions"]],
        )
        found.save(self.folder / "again.json")
        self.assertEqual(json.loads((self.folder / "again.json").read_text()), expected)

    def test_corrected_models_are_those_of_export(self) -> None:
        file = self.folder / "models.json"
        done = command(
            *("export", "--as", "state-space-json", "--correction", "own", "--condition", 10),
            *("--pade", 3, "--out", file),
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        expected = json.loads(file.read_text())["models"][0]
        found = with_delays()[10].state_space(pade=3)
        self.assertEqual(found.A.tolist(), expected["A"])
        self.assertEqual(found.D.tolist(), expected["D"])
        self.assertEqual(list(found.states), expected["states"])

    def test_a_figure_is_that_of_the_command(self) -> None:
        file = self.folder / "bode.svg"
        done = command(
            *("figure", "--view", "bode", "--condition", 10, "--pair", "Q/LON", "--out", file)
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        figure = with_delays().figure("bode", condition=10, response=("Q", "LON"))
        self.assertEqual(figure.svg, file.read_text())
        self.assertEqual(figure._repr_svg_(), figure.svg)
        figure.save(self.folder / "bode.png")
        self.assertEqual((self.folder / "bode.png").read_bytes()[:4], b"\x89PNG")
        with self.assertRaises(gdcm.Error) as raised:
            figure.save(self.folder / "bode.png")
        self.assertEqual(raised.exception.code, "output-exists")
        figure.save(self.folder / "bode.png", force=True)
        self.assertGreater(len(figure.to_frame()), 500)

    def test_result_files_are_those_of_analyze(self) -> None:
        with_delays().write_results(self.folder / "module")
        command("analyze", "--out", self.folder / "command")
        for file in sorted((self.folder / "command").iterdir()):
            self.assertEqual(
                file.read_bytes(), (self.folder / "module" / file.name).read_bytes(), file.name
            )

    def test_every_option_is_a_keyword(self) -> None:
        # Parameters that are no options, and options that are no parameters.
        exceptions = {
            "analyze": ({"data", "progress"}, {"--dataset", "--strict", "--reject-suggested"}),
            "identify": (
                {"records", "progress"},
                {"--into", "--condition", "--every-condition", "--take", "--description"}
                | {"--out", "--force"},
            ),
            "assemble": ({"folders"}, {"--out", "--force"}),
        }
        for name, (keywords, options) in exceptions.items():
            expected = set(_gdcm.options(name)) - options
            found = set(inspect.signature(getattr(gdcm, name)).parameters) - keywords
            self.assertEqual({"--" + word.replace("_", "-") for word in found}, expected, name)
        # A figure takes the options of its analysis from the analysis.
        analysis = set(_gdcm.options("analyze"))
        expected = set(_gdcm.options("figure")) - analysis - {"--out", "--force"}
        found = set(inspect.signature(gdcm.Analysis.figure).parameters) - {"self", "progress"}
        found = {"--" + word.replace("_", "-") for word in found}
        self.assertEqual(found - {"--response"} | {"--pair"}, expected)


class Script(Folder):
    """The script `gdcm` is the program, with its exit statuses."""

    def test_exit_status_is_0_for_success_2_for_wrong_input_1_for_no_result(self) -> None:
        version = command("--version")
        self.assertEqual((version.returncode, version.stdout.split()[0]), (0, "gdcm"))
        self.assertIn(gdcm.__version__, version.stdout)
        self.assertEqual(command("example", self.folder).returncode, 0)
        self.assertEqual(command("check", self.folder / "nothing.json").returncode, 2)
        self.assertEqual(command("analyze", "--no-such-option").returncode, 2)
        # The files exist.
        self.assertEqual(command("example", self.folder).returncode, 2)
        contents = json.loads((self.folder / "example-dataset.json").read_text())
        for condition in contents["conditions"]:
            condition["identified_models"] = []
        (self.folder / "unidentified.json").write_text(json.dumps(contents))
        done = command("analyze", self.folder / "unidentified.json", "--out", self.folder)
        self.assertEqual(done.returncode, 1, done.stderr)

    def test_without_a_display_the_window_ends_with_status_1(self) -> None:
        displays = ("DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET")
        environment = {name: value for name, value in os.environ.items() if name not in displays}
        done = command(environment=environment)
        self.assertEqual(done.returncode, 1)
        self.assertIn("gdcm analyze", done.stderr)

    def test_the_package_runs_as_a_program_and_as_a_function(self) -> None:
        done = subprocess.run(
            [sys.executable, "-m", "gdcm", "check", "nothing.json"],
            capture_output=True,
            check=False,
        )
        self.assertEqual(done.returncode, 2)
        handler = signal.getsignal(signal.SIGINT)
        self.assertEqual(gdcm.main(["check", str(self.folder / "nothing.json")]), 2)
        self.assertEqual(signal.getsignal(signal.SIGINT), handler)

    def test_ctrl_c_ends_a_command(self) -> None:
        words = ["gdcm", "identify", *map(str, records()), "--inputs", "LON", "--outputs", "Q"]
        words += ["--band", "0.5", "12", "--out", str(self.folder)]
        running = subprocess.Popen(
            words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        assert running.stdout is not None
        # The table of the records is printed just before the work begins. A signal in between ends
        # the process at once; during the work, the command ends with status 1.
        running.stdout.readline()
        running.send_signal(signal.SIGINT)
        _, stderr = running.communicate()
        if running.returncode != -signal.SIGINT:
            self.assertEqual(running.returncode, 1, stderr)
            self.assertIn("stopped", stderr)
        self.assertEqual(os.listdir(self.folder), [])


class Errors(Folder):
    """Errors are exceptions with the codes of the program."""

    def error_of(self, call: Any) -> gdcm.Error:
        """Return the error that a call raises."""
        with self.assertRaises(gdcm.Error) as raised:
            call()
        return raised.exception

    def test_missing_and_damaged_files(self) -> None:
        missing = self.folder / "nothing.json"
        error = self.error_of(lambda: gdcm.load(missing))
        self.assertEqual((error.code, error.status), ("missing-file", 2))
        self.assertEqual(error.fields["path"], str(missing))
        (self.folder / "damaged.json").write_text('{"format": "gdcm-dataset",\n "version": 1,')
        error = self.error_of(lambda: gdcm.load(self.folder / "damaged.json"))
        self.assertEqual((error.code, error.fields["line"]), ("json-cut-off", 2))
        error = self.error_of(
            lambda: gdcm.identify(missing, inputs="LON", outputs="Q", band=(1, 2))
        )
        self.assertEqual(error.code, "missing-file")
        empty = self.folder / "empty"
        empty.mkdir()
        error = self.error_of(lambda: gdcm.assemble(empty))
        self.assertEqual(error.code, "incomplete-rules")
        self.assertTrue(error.errors)

    def test_wrong_settings(self) -> None:
        error = self.error_of(lambda: gdcm.analyze(example(), phase="sideways"))
        self.assertEqual(error.code, "wrong-option")
        self.assertEqual(error.fields["option"], "--phase")
        error = self.error_of(lambda: gdcm.analyze(example(), reject=[(3, "nobody")]))
        self.assertEqual(error.code, "unknown-model")
        error = self.error_of(lambda: gdcm.analyze(example(), on=[("Q", "STICK")]))
        self.assertEqual(error.code, "unknown-response")
        error = self.error_of(lambda: gdcm.analyze(example(), quantile=2.0))
        self.assertEqual(error.fields["option"], "--quantile")
        with self.assertRaises(TypeError):
            gdcm.analyze(example(), alpha=object())  # type: ignore[arg-type]

    def test_missing_results(self) -> None:
        fix = with_delays()
        error = self.error_of(lambda: fix.figure("bode", response=("Q", "LON")))
        self.assertEqual(error.code, "missing-condition")
        error = self.error_of(lambda: fix[10].response(OMEGA, model="nobody"))
        self.assertEqual(error.code, "unknown-model")
        error = self.error_of(lambda: fix[10].response([0.0, 1.0]))
        self.assertEqual(error.code, "wrong-frequencies")
        error = self.error_of(lambda: fix[10].state_space(pade=99))
        self.assertEqual(error.fields["option"], "--pade")
        with self.assertRaises(KeyError):
            fix[99]
        contents = json.loads(json.dumps(example().contents))
        for condition in contents["conditions"]:
            condition["identified_models"] = []
        unidentified = gdcm.Dataset.from_dict(contents)
        error = self.error_of(lambda: gdcm.analyze(unidentified))
        self.assertEqual((error.code, error.status), ("no-result", 1))
        contents = json.loads(json.dumps(example().contents))
        contents["conditions"][0]["identified_models"] = []
        fix = gdcm.analyze(gdcm.Dataset.from_dict(contents))
        first = contents["conditions"][0]["id"]
        self.assertEqual([(f.code, f.conditions) for f in fix.failed], [("no-reference", (first,))])
        self.assertEqual(self.error_of(lambda: fix[first]).code, "no-reference")

    def test_unclear_records_and_wrong_band(self) -> None:
        error = self.error_of(
            lambda: gdcm.identify(records(), inputs="STICK", outputs="Q", band=(0.5, 12))
        )
        self.assertEqual((error.code, error.errors[0].code), ("unclear-records", "no-column"))
        error = self.error_of(
            lambda: gdcm.identify(records(), inputs="LON", outputs="Q", band=(12, 0.5))
        )
        self.assertEqual(error.fields["option"], "--band")

    def test_an_error_can_be_sent_to_another_process(self) -> None:
        error = self.error_of(lambda: gdcm.load(self.folder / "nothing.json"))
        restored = pickle.loads(pickle.dumps(error))
        self.assertEqual((restored.code, str(restored)), (error.code, str(error)))
        self.assertEqual(restored.fields, error.fields)


class LongWork(unittest.TestCase):
    """Long work reports progress, can be stopped, and releases the interpreter lock."""

    def test_progress_is_reported_in_the_calling_thread(self) -> None:
        reports = []

        def report(fraction: float, step: str) -> None:
            reports.append((fraction, step, threading.current_thread()))

        gdcm.identify(records(), inputs="LON", outputs="Q", band=(0.5, 12), progress=report)
        fractions = [fraction for fraction, _, _ in reports]
        # Short work reports only its end: how often it reports depends on the machine.
        self.assertTrue(all(0.0 <= fraction <= 1.0 for fraction in fractions))
        self.assertEqual(fractions[-1], 1.0)
        self.assertTrue(all(isinstance(step, str) for _, step, _ in reports))
        self.assertEqual({thread for _, _, thread in reports}, {threading.current_thread()})

    def test_an_exception_in_the_callback_stops_the_work(self) -> None:
        class Stop(Exception):
            pass

        def stop(fraction: float, step: str) -> None:
            raise Stop

        begin = time.monotonic()
        with self.assertRaises(Stop):
            gdcm.identify(records(), inputs="LON", outputs="Q", band=(0.5, 12), progress=stop)
        self.assertLess(time.monotonic() - begin, 30.0)
        # The module still works: 11 conditions.
        self.assertEqual(len(gdcm.analyze(example(), points=20)), 11)

    def test_ctrl_c_stops_the_work(self) -> None:
        # A process that a shell starts in the background ignores Ctrl+C unless a handler is set.
        handler = signal.signal(signal.SIGINT, signal.default_int_handler)
        self.addCleanup(signal.signal, signal.SIGINT, handler)

        def interrupt(fraction: float, step: str) -> None:
            os.kill(os.getpid(), signal.SIGINT)

        for call in (
            lambda: gdcm.analyze(example(), phase="lead", progress=interrupt),
            lambda: gdcm.identify(
                records(), inputs="LON", outputs="Q", band=(0.5, 12), progress=interrupt
            ),
        ):
            with self.assertRaises(KeyboardInterrupt):
                call()
        self.assertEqual(len(gdcm.analyze(example(), points=20)), 11)

    def test_other_threads_run_meanwhile(self) -> None:
        done = threading.Event()

        def work() -> None:
            gdcm.identify(records(), inputs="LON", outputs="Q", band=(0.5, 12))
            done.set()

        worker = threading.Thread(target=work)
        turns = 0
        worker.start()
        while not done.wait(0.001):
            turns += 1
        worker.join()
        # The counter advances only while the interpreter lock is released.
        self.assertGreater(turns, 0)

    def test_two_analyses_at_once_give_the_same_results(self) -> None:
        results: List[Any] = [None, None]

        def work(index: int) -> None:
            results[index] = gdcm.analyze(example(), phase="lead", reject="suggested")

        workers = [threading.Thread(target=work, args=(index,)) for index in range(2)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        for result in results:
            self.assertEqual(result.corrections, with_leads().corrections)
            self.assertEqual(
                [caution.code for caution in result.cautions],
                [caution.code for caution in with_leads().cautions],
            )


class Arrays(Folder):
    """Models as arrays, in and out."""

    def test_a_dataset_survives_its_arrays(self) -> None:
        data = example()
        rebuilt = gdcm.Dataset(
            list(data.conditions.values()),
            inputs=data.inputs,
            outputs=data.outputs,
            band=data.band,
            on_axis=data.on_axis,
            name=data.name,
        )
        for id_, condition in data.conditions.items():
            found = rebuilt.conditions[id_]
            self.assertEqual(found.nominal.A.tolist(), condition.nominal.A.tolist())
            self.assertEqual(list(found.perturbed), list(condition.perturbed))
            self.assertEqual(found.perturbations, condition.perturbations)
            self.assertEqual(list(found.identified), list(condition.identified))
        fix = gdcm.analyze(rebuilt, phase="lead", reject="suggested")
        self.assertEqual(
            without_source(fix.corrections), without_source(with_leads().corrections)
        )

    def one_axis(self, nominal: Any, flight: Any) -> gdcm.Dataset:
        """Return a dataset with one condition, one input and one output."""
        condition = gdcm.Condition(1, 60.0, nominal, identified={"flight": flight})
        return gdcm.Dataset(
            [condition],
            inputs={"LON": "%"},
            outputs=[("Q", "deg/s")],
            band=(0.5, 12.0),
            on_axis=[("Q", "LON")],
        )

    def test_models_of_other_packages_are_accepted(self) -> None:
        import control
        import scipy.signal

        # First-order lags with the gains 2.0 and 2.4: the correction is a gain of 1.2.
        matrices = ([[-1.0]], [[1.0]], [[2.0]], [[0.0]])
        flight = ([[-1.0]], [[1.0]], [[2.4]], [[0.0]])
        for nominal in (
            matrices,
            gdcm.StateSpace(*matrices),
            control.ss(*matrices),
            scipy.signal.StateSpace(*matrices),
        ):
            fix = gdcm.analyze(self.one_axis(nominal, flight))
            self.assertAlmostEqual(fix[1].net_gain["Q", "LON"], 1.2, places=9)
        sampled = control.ss([[0.98]], [[0.02]], [[2.0]], [[0.0]], 0.02)
        data = self.one_axis(sampled, flight)
        self.assertEqual(data.conditions[1].nominal.sample_time_s, 0.02)
        measured = control.frd(control.ss(*flight), OMEGA)
        fix = gdcm.analyze(self.one_axis(matrices, measured))
        self.assertAlmostEqual(fix[1].net_gain["Q", "LON"], 1.2, places=3)

    def test_measured_responses_keep_their_coherence(self) -> None:
        flight = 2.4 / (1j * OMEGA + 1.0)
        measured = gdcm.FrequencyResponse(
            OMEGA,
            flight[np.newaxis, np.newaxis],
            coherence=np.full((1, 1, OMEGA.size), 0.9),
            averages=20,
            window_s=30.0,
        )
        data = self.one_axis(([[-1.0]], [[1.0]], [[2.0]], [[0.0]]), measured)
        found = data.conditions[1].identified["flight"]
        np.testing.assert_array_equal(found.H, measured.H)
        np.testing.assert_array_equal(found.coherence, measured.coherence)
        self.assertEqual((found.averages, found.window_s), (20.0, 30.0))
        self.assertEqual(gdcm.analyze(data).settings["coherence_threshold"], 0.6)

    def test_wrong_arrays_are_refused_with_their_place(self) -> None:
        good = ([[-1.0]], [[1.0]], [[2.0]], [[0.0]])
        for wrong, code in (
            (([[-1.0]], [[1.0, 2.0]], [[2.0]], [[0.0]]), "matrix-shape"),
            (([[np.nan]], [[1.0]], [[2.0]], [[0.0]]), "number-not-finite"),
        ):
            with self.assertRaises(gdcm.Error) as raised:
                self.one_axis(wrong, good)
            self.assertEqual(raised.exception.code, code)
            self.assertIn("condition 1", raised.exception.fields["place"])
        with self.assertRaises(TypeError):
            self.one_axis("nominal", good)

    def test_responses_are_those_of_the_matrices_with_exact_delays(self) -> None:
        fix = with_delays()
        nominal = example().conditions[4].nominal
        identity = np.eye(nominal.order)
        responses = []
        for omega in OMEGA:
            states = np.linalg.solve(1j * omega * identity - nominal.A, nominal.B)
            responses.append(nominal.C @ states + nominal.D)
        plain = np.stack(responses, axis=-1)
        np.testing.assert_allclose(example().response(4, OMEGA), plain, rtol=1e-8, atol=1e-12)
        gains = fix[4].net_gain.array[:, :, np.newaxis]
        delays_s = fix[4].net_delay_s.array[:, :, np.newaxis]
        self.assertGreater(delays_s.max(), 0.0)
        expected = plain * gains * np.exp(-1j * OMEGA * delays_s)
        found = fix[4].response(OMEGA)
        self.assertEqual((found.shape, found.dtype), ((6, 4, 50), np.dtype(complex)))
        np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-12)
        scheduled = fix.schedule.at(fix[4].airspeed_kt)
        corrected = fix[4].response(OMEGA, correction="scheduled")
        factor = scheduled.gains["Q"] * scheduled.gains["LON"]
        row, column = fix.outputs.index("Q"), fix.inputs.index("LON")
        delay_s = scheduled.delays_s["Q"] + scheduled.delays_s["LON"]
        np.testing.assert_allclose(
            corrected[row, column],
            plain[row, column] * factor * np.exp(-1j * OMEGA * delay_s),
            rtol=1e-8,
        )

    def test_the_response_includes_the_leads(self) -> None:
        fix = with_leads()
        leads = fix[10].leads
        assert leads is not None
        row, column = fix.outputs.index("Q"), fix.inputs.index("LON")
        ratio = (fix[10].response(OMEGA) / example().response(10, OMEGA))[row, column]
        expected = np.full(OMEGA.shape, fix[10].net_gain["Q", "LON"], dtype=complex)
        for lead in (leads.outputs["Q"], leads.inputs["LON"]):
            # A critically damped second-order lead over such a lag, with unit static gain (M15.3).
            zero, lag = lead["zero_rad_s"], lead["lag_rad_s"]
            expected *= ((1j * OMEGA / zero + 1.0) / (1j * OMEGA / lag + 1.0)) ** 2
        # Apart from the leads, less than 0.15 rad of phase is left; with them, the phase at the
        # upper end of the band is advanced by more than 0.3 rad.
        phase = np.angle(ratio / expected)
        self.assertLess(np.abs(phase).max(), 0.15)
        self.assertGreater(np.angle(ratio[-1]), 0.3)

    def test_corrected_models_for_control_have_the_response(self) -> None:
        import control

        system = with_delays()[10].to_control(pade=3)
        self.assertIsInstance(system, control.StateSpace)
        self.assertEqual(system.input_labels, list(with_delays().inputs))
        self.assertEqual(system.output_labels, list(with_delays().outputs))
        found = control.frequency_response(system, OMEGA).frdata
        np.testing.assert_allclose(
            found, with_delays()[10].response(OMEGA), rtol=1e-5, atol=1e-9
        )
        reference = identified().to_control()
        found = control.frequency_response(reference, OMEGA, squeeze=False).frdata
        np.testing.assert_allclose(found, identified().response(OMEGA), rtol=1e-7)

    def test_delays_beside_the_matrices_need_an_order_for_control(self) -> None:
        import control

        model = gdcm.StateSpace(
            [[-1.0]], [[1.0, 0.5]], [[2.0]], [[0.0, 0.0]], input_delays_s=[0.05, 0.0]
        )
        with self.assertRaises(ValueError):
            model.to_control()
        found = control.frequency_response(model.to_control(pade=4), OMEGA).frdata
        plain = 2.0 / (1j * OMEGA + 1.0)
        np.testing.assert_allclose(found[0, 0], plain * np.exp(-0.05j * OMEGA), rtol=1e-6)
        np.testing.assert_allclose(found[0, 1], 0.5 * plain, rtol=1e-12)

    def test_a_study_of_arrays_is_saved_with_its_dataset(self) -> None:
        matrices = ([[-1.0]], [[1.0]], [[2.0]], [[0.0]])
        flight = ([[-1.0]], [[1.0]], [[2.4]], [[0.0]])
        fix = gdcm.analyze(self.one_axis(matrices, flight), phase="none", alpha=0.5)
        study = self.folder / "axis.gdcm-study.json"
        fix.save(study)
        self.assertTrue((self.folder / "axis.dataset.json.gz").exists())
        self.assertEqual(command("check", study, "--strict").returncode, 0)
        loaded = gdcm.analyze(gdcm.load(study, strict=True))
        self.assertEqual(loaded.settings["alpha_gain"], 0.5)
        self.assertEqual(without_source(loaded.corrections), without_source(fix.corrections))

    def test_a_study_of_the_example_keeps_its_decisions(self) -> None:
        study = self.folder / "aw.gdcm-study.json"
        with_leads().save(study)
        self.assertEqual(os.listdir(self.folder), [study.name])
        loaded = gdcm.analyze(gdcm.load(study))
        self.assertEqual(loaded.corrections, with_leads().corrections)
        dataset = self.folder / "dataset.json"
        example().save(dataset)
        self.assertEqual(gdcm.load(dataset).contents, example().contents)
        with self.assertRaises(gdcm.Error) as raised:
            example().save(dataset)
        self.assertEqual(raised.exception.code, "output-exists")

    def test_identified_models_go_into_a_dataset(self) -> None:
        found = identified()
        nominal = ([[-1.0]], [[1.0]], [[2.0]], [[0.0]])
        extended = found.put_into(self.one_axis(nominal, nominal), 1)
        models = extended.conditions[1].identified
        self.assertEqual(
            models[found.model.name].A.tolist(), found.model.A.tolist()
        )
        self.assertEqual(len(gdcm.analyze(extended)), 1)
        with self.assertRaises(gdcm.Error) as raised:
            found.put_into(example(), 10)
        self.assertEqual(raised.exception.code, "other-channels")

    def test_rules_for_files_are_assembled_to_a_dataset(self) -> None:
        done = command("example", self.folder)
        self.assertEqual(done.returncode, 0)
        real = self.folder / "real"
        command("example", real, "--real")
        data = gdcm.assemble(real / "antx" / "physics.json")
        self.assertTrue(data.conditions)
        self.assertIsNotNone(data.rules)
        self.assertIsNone(example().rules)


class Frames(unittest.TestCase):
    """Tables for pandas, and the errors where a package is missing."""

    def test_frames_have_the_values_of_the_results(self) -> None:
        fix = with_leads()
        # 11 conditions; 6 outputs and 4 inputs.
        channels = fix.to_frame()
        self.assertEqual(len(channels), 11 * 10)
        row = channels[(channels["condition"] == 10) & (channels["channel"] == "LON")]
        self.assertEqual(row["gain"].item(), fix[10].gains["LON"])
        responses = fix.to_frame("responses")
        self.assertEqual(len(responses), 11 * 24)
        schedule = fix.schedule.to_frame()
        self.assertEqual(
            schedule.loc[45.0, ("gain", "LON")], fix.schedule.at(45.0).gains["LON"]
        )
        measured = identified().to_frame()
        self.assertEqual(len(measured), identified().measured.omega.size)
        with self.assertRaises(ValueError):
            fix.to_frame("everything")

    def test_missing_packages_are_named(self) -> None:
        with mock.patch.dict(sys.modules, {"control": None}):
            with self.assertRaisesRegex(ImportError, "pip install control"):
                with_delays()[10].to_control()
        with mock.patch.dict(sys.modules, {"pandas": None}):
            with self.assertRaisesRegex(ImportError, "pip install pandas"):
                with_delays().to_frame()


if __name__ == "__main__":
    unittest.main()
