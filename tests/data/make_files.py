"""Writes the files of `npy`, `mat73` and `records` beside this script, and loads the archive that the program wrote.

Needs numpy, scipy and h5py. MATLAB's conventions are imitated, after the descriptions of the matio and hdf5storage projects; no file here
was written by MATLAB itself.
"""

import io
import json
import os
import zipfile

import h5py
import numpy as np
from scipy.io import savemat

HERE = os.path.dirname(os.path.abspath(__file__))
NPY = os.path.join(HERE, "npy")
MAT = os.path.join(HERE, "mat73")


def npy_files():
    def save(name, array, version=None):
        with open(os.path.join(NPY, name + ".npy"), "wb") as file:
            np.lib.format.write_array(file, np.asanyarray(array), version=version)

    matrix = np.array([[1.0, 2, 3], [4, 5, 6]])
    save("matrix_c", matrix)
    save("matrix_fortran", np.asfortranarray(matrix))
    save("matrix_big_endian", matrix.astype(">f8"))
    save("matrix_version_2", matrix, (2, 0))
    save("matrix_version_3", matrix, (3, 0))
    save("scalar", np.array(2.5))
    save("list", np.array([1.0, 2, 3]))
    save("empty", np.zeros((0, 4)))
    save("cube", np.arange(24.0).reshape(2, 3, 4))
    for kind in ["i1", "i2", "i4", "i8"]:
        save(kind, np.array([-3, 0, 100], kind))
    save("i2_big_endian", np.array([-3, 0, 100], ">i2"))
    for kind in ["u1", "u2", "u4", "u8"]:
        save(kind, np.array([0, 7, 200], kind))
    for kind in ["f2", "f4"]:
        save(kind, np.array([-0.5, 1.25, np.inf], kind))
    save("bool", np.array([True, False, True]))
    for kind in ["c8", "c16"]:
        save(kind, np.array([1 + 2j, -3 + 0.5j], kind))
    save("unicode", np.array([["u", "θ_dot"], ["", "phi"]]))
    save("unicode_big_endian", np.array(["u", "θ_dot"], ">U5"))
    save("bytes", np.array([b"u", b"theta"]))
    fields = np.dtype([("name", "<U3"), ("gain", "<f8"), ("place", "<i2", (3,))], align=True)
    save("records", np.array([("q", 1.5, [1, 2, 3]), ("phi", -2.0, [4, 5, 6])], fields))
    save("objects", np.array([1, "a"], dtype=object))


def npz_files():
    arrays = dict(A=np.array([[1.0, 2], [3, 4]]), b=np.array([1.0, 2, 3]), names=np.array(["u", "w"]))
    np.savez(os.path.join(NPY, "stored.npz"), **arrays)
    np.savez_compressed(os.path.join(NPY, "compressed.npz"), **arrays)
    np.savez_compressed(os.path.join(NPY, "bomb.npz"), zeros=np.zeros(1_000_000))
    stream = io.BytesIO()
    np.save(stream, np.array([1.0]))
    with zipfile.ZipFile(os.path.join(NPY, "with_text.npz"), "w") as archive:
        archive.writestr("a.npy", stream.getvalue())
        archive.writestr("readme.txt", "made by hand")
    with zipfile.ZipFile(os.path.join(NPY, "duplicate.npz"), "w") as archive:
        archive.writestr("a.npy", stream.getvalue())
        archive.writestr("a.npy", stream.getvalue())


def check_written():
    path = os.path.join(NPY, "written.npz")
    if not os.path.exists(path):
        return
    with np.load(path) as archive:
        assert sorted(archive.files) == ["A", "c", "i", "names", "t"]
        assert (archive["A"] == [[1, 2, 3], [4, 5, np.inf]]).all()
        assert (archive["c"] == [[1 + 0.5j, 2 - 0.5j]]).all()
        assert (archive["i"] == [[-3, 4]]).all() and archive["i"].dtype == np.int64
        assert (archive["t"] == [[True], [False]]).all() and archive["t"].dtype == bool
        assert archive["names"].tolist() == [["u", "θ_dot"]]


def matlab_header():
    text = b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Mon Jan  1 00:00:00 2024 HDF5 schema 1.00 ."
    return text.ljust(116) + bytes(8) + b"\x00\x02IM" + bytes(384)


class MatlabFile:
    """A file with MATLAB's conventions: dimensions reversed, attributes of fixed length, references into `#refs#`."""

    def __init__(self, name, **options):
        self.path = os.path.join(MAT, name + ".mat")
        self.file = h5py.File(self.path, "w", userblock_size=512, **options)
        self.count = 0

    def close(self):
        self.file.close()
        with open(self.path, "r+b") as file:
            file.write(matlab_header())

    def mark(self, node, name, **attributes):
        node.attrs.create("MATLAB_class", np.bytes_(name))
        for key, value in attributes.items():
            node.attrs.create("MATLAB_" + key, value)
        return node

    def place(self):
        """A new name in `#refs#`."""
        self.count += 1
        return f"#refs#/r{self.count}"

    def numbers(self, path, array, name=None, **options):
        array = np.asarray(array)
        names = {"f8": "double", "f4": "single", "b1": "logical"}
        kind = array.dtype.str[1:]
        name = name or names.get(kind) or array.dtype.name
        if array.size == 0:
            dims = np.array(array.shape, dtype=np.uint64)
            return self.mark(self.file.create_dataset(path, data=dims), name, empty=np.uint8(1))
        attributes = {"int_decode": np.int32(1)} if kind == "b1" else {}
        if kind == "b1":
            array = array.astype("u1")
        if array.dtype.kind == "c":
            pair = np.dtype([("real", "<f8"), ("imag", "<f8")])
            array, name = array.astype("c16").view(pair), "double"
        return self.mark(self.file.create_dataset(path, data=array.T, **options), name, **attributes)

    def char(self, path, rows):
        """One text, or rows of the same length."""
        rows = [rows] if isinstance(rows, str) else rows
        codes = np.array([np.frombuffer(row.encode("utf-16-le"), "<u2") for row in rows])
        if codes.size == 0:
            dims = np.array([0, 0], dtype=np.uint64)
            dataset = self.file.create_dataset(path, data=dims)
            return self.mark(dataset, "char", empty=np.uint8(1), int_decode=np.int32(2))
        return self.mark(self.file.create_dataset(path, data=codes.T), "char", int_decode=np.int32(2))

    def references(self, path, shape, write):
        """`write(path, i)` writes element i, column by column; the array of references is of MATLAB's `shape`."""
        references = np.empty(int(np.prod(shape)), dtype=h5py.ref_dtype)
        for i in range(references.size):
            place = self.place()
            write(place, i)
            references[i] = self.file[place].ref
        return self.file.create_dataset(path, data=references.reshape(shape[::-1]), dtype=h5py.ref_dtype)

    def cell(self, path, shape, write):
        return self.mark(self.references(path, shape, write), "cell")

    def struct(self, path, names):
        group = self.mark(self.file.create_group(path), "struct")
        letters = h5py.vlen_dtype(np.dtype("S1"))
        fields = np.empty(len(names), dtype=object)
        for i, name in enumerate(names):
            fields[i] = np.array([letter.encode() for letter in name], dtype="S1")
        group.attrs.create("MATLAB_fields", fields, dtype=letters)
        return group

    def empty(self, path, shape, name):
        dims = self.file.create_dataset(path, data=np.array(shape, np.uint64))
        self.mark(dims, name, empty=np.uint8(1))


def matlab_numbers():
    numbers = MatlabFile("numbers")
    numbers.numbers("A", np.array([[1.0, 2, 3], [4, 5, 6]]))
    numbers.numbers("single", np.array([[0.5, -0.25]], "f4"))
    for kind in ["i1", "i2", "i4", "i8"]:
        numbers.numbers(np.dtype(kind).name, np.array([[-3], [100]], kind))
    for kind in ["u1", "u2", "u4", "u8"]:
        numbers.numbers(np.dtype(kind).name, np.array([[3], [200]], kind))
    numbers.numbers("flags", np.array([[True, False, True]]))
    numbers.numbers("z", np.array([[1 + 2j, -3 + 0.5j]]))
    numbers.numbers("none", np.zeros((0, 3)))
    numbers.numbers("cube", np.arange(24.0).reshape(2, 3, 4))
    packed = dict(compression="gzip", compression_opts=6, shuffle=True, chunks=(10, 7))
    numbers.numbers("packed", np.arange(600.0).reshape(20, 30), **packed)
    sparse = numbers.mark(numbers.file.create_group("S"), "double", sparse=np.uint64(3))
    sparse["data"], sparse["ir"] = np.array([1.5, -2.0]), np.array([2, 0], np.uint64)
    sparse["jc"] = np.array([0, 1, 1, 2, 2], np.uint64)
    nothing = numbers.mark(numbers.file.create_group("S0"), "logical", sparse=np.uint64(2), int_decode=np.int32(1))
    nothing["jc"] = np.array([0, 0, 0], np.uint64)
    numbers.close()


def matlab_nested():
    nested = MatlabFile("nested")
    nested.char("name", "theta_dot")
    nested.char("greek", "θ𝛼")
    nested.char("rows", ["ab ", "cde"])
    nested.char("nothing", "")
    nested.struct("sys", ["B", "A", "name", "inner"])
    nested.numbers("sys/A", np.array([[1.0, 2], [3, 4]]))
    nested.numbers("sys/B", np.array([[5.0], [6]]))
    nested.char("sys/name", "hover")
    nested.struct("sys/inner", ["x"])
    nested.numbers("sys/inner/x", np.array([[7.0]]))
    nested.mark(nested.file.create_group("models"), "struct")
    nested.references("models/gain", (1, 3), lambda path, i: nested.numbers(path, np.array([[float(i)]])))
    nested.references("models/name", (1, 3), lambda path, i: nested.char(path, "uvw"[i]))

    def mixed(path, i):
        if i == 5:
            nested.cell(path, (1, 1), lambda path, i: nested.char(path, "deep"))
        else:
            nested.numbers(path, np.array([[float(i)]]))

    nested.cell("C", (2, 3), mixed)
    nested.empty("C0", [0, 1], "cell")
    nested.empty("T0", [0, 0], "struct")
    handle = nested.mark(nested.file.create_group("f"), "function_handle", object_decode=np.int32(1))
    handle["function_handle"] = np.frombuffer("@(x)x".encode("utf-16-le"), "<u2")
    nested.close()


def matlab_objects():
    objects = MatlabFile("objects")
    reference = np.array([[0xDD000000], [2], [1], [1], [1], [1]], np.uint32)
    objects.mark(objects.file.create_dataset("sys", data=reference.T), "ss", object_decode=np.int32(3))
    objects.numbers("before", np.array([[1.0]]))
    long = np.array([[2**64 - 1]], np.uint64)
    cells = [np.array([[4, 0, 0, 0]], np.uint8), np.array([[9.0]]), long]
    objects.references("#subsystem#/MCOS", (3, 1), lambda path, i: objects.numbers(path, cells[i]))
    objects.mark(objects.file["#subsystem#/MCOS"], "FileWrapper__", object_decode=np.int32(3))
    objects.close()


def matlab_hostile():
    circle = MatlabFile("circle")
    cell = circle.cell("C", (1, 1), lambda path, i: circle.numbers(path, np.array([[1.0]])))
    cell[0, 0] = cell.ref
    circle.close()
    laughs = MatlabFile("laughs", libver="latest")
    last = laughs.numbers("last", np.array([[1.0]]))
    for level in range(30):
        references = np.full((10, 1), last.ref, dtype=h5py.ref_dtype)
        last = laughs.mark(laughs.file.create_dataset(f"#refs#/level{level}", data=references), "cell")
    laughs.file["C"] = last
    laughs.close()
    huge = MatlabFile("huge")
    huge.mark(huge.file.create_dataset("claims", shape=(1_000_000_000, 1000), chunks=(1000, 1000), dtype="f8"), "double")
    huge.close()
    huge = MatlabFile("huge_sparse")
    sparse = huge.mark(huge.file.create_group("S"), "double", sparse=np.uint64(1 << 62))
    sparse["jc"] = np.zeros(5, np.uint64)
    huge.close()
    huge = MatlabFile("huge_empty")
    huge.empty("E", [1 << 40, 1 << 40], "double")
    huge.close()


def plain_file(name, **options):
    with h5py.File(os.path.join(MAT, name + ".h5"), "w", **options) as file:
        file["A"] = np.array([[1.0, 2, 3], [4, 5, 6]])
        file["big_endian"] = np.array([[1, 2, 3], [4, 5, 6]], ">i4")
        file["half"] = np.array([0.5, 1.25], "f2")
        file["scalar"] = 2.5
        file["cube"] = np.arange(24.0).reshape(2, 3, 4)
        file["flags"] = np.array([True, False])
        file["z"] = np.array([1 + 2j, -3 + 0.5j])
        file["text"] = "hover θ"
        file["names"] = ["u", "theta", ""]
        file["fixed"] = np.array([b"u", b"theta"])
        file["nothing"] = h5py.Empty("f8")
        file["no_rows"] = np.zeros((0, 3))
        packed = dict(chunks=(7, 11), compression="gzip", shuffle=True)
        file.create_dataset("packed", data=np.arange(600.0).reshape(20, 30), **packed)
        summed = dict(chunks=(7, 2), fletcher32=True, maxshape=(None, 3))
        file.create_dataset("summed", data=np.arange(60.0).reshape(20, 3), **summed)
        file.create_dataset("unwritten", shape=(2, 2), fillvalue=7.0)
        file["group/inner/x"] = np.array([1.0])
        file["group/A"] = file["A"]
        file.create_group("empty")
        fields = np.dtype([("name", "S3"), ("gain", "<f8")])
        file["records"] = np.array([(b"q", 1.5), (b"phi", -2.0)], fields)
        ragged = file.create_dataset("ragged", (1,), dtype=h5py.vlen_dtype(np.dtype("f8")))
        ragged[0] = [1.0, 2.0]
        file["A"].attrs["unit"] = "m/s"


def plain_files():
    plain_file("plain")
    plain_file("plain_latest", libver=("v114", "v114"))
    with h5py.File(os.path.join(MAT, "hdf5_2.h5"), "w", libver="latest") as file:
        file.create_dataset("packed", data=np.arange(6.0).reshape(2, 3), chunks=(2, 2), compression="gzip")
        file["x"] = 1.0
    with h5py.File(os.path.join(MAT, "circle.h5"), "w") as file:
        file["a/x"] = 1.0
        file["a/here"] = file["a"]
    with h5py.File(os.path.join(MAT, "links.h5"), "w") as file:
        file["x"] = 1.0
        file["soft"] = h5py.SoftLink("/x")
        file["broken"] = h5py.SoftLink("/nowhere")
        file["outside"] = h5py.ExternalLink("other.h5", "/x")
    with h5py.File(os.path.join(MAT, "deep.h5"), "w", libver="latest") as file:
        file["/".join(["g"] * 80)] = 1.0
    with h5py.File(os.path.join(MAT, "name.h5"), "w") as file:
        file[b"\xff\xfe"] = 1.0


def record_files():
    """One flight record of 60 samples at 50 Hz in every format: t, LON, LAT in %, P in rad/s, NZ in g."""
    folder = os.path.join(HERE, "records")
    os.makedirs(folder, exist_ok=True)
    place = lambda name: os.path.join(folder, name)
    k = np.arange(60)
    t = np.round(0.02 * k, 2)
    lon, lat = np.round(50 + 10 * np.sin(0.3 * k), 3), np.round(45 + 8 * np.cos(0.2 * k), 3)
    p, nz = np.round(0.3 * np.sin(0.25 * k), 4), np.round(1 + 0.2 * np.cos(0.35 * k), 4)
    columns = np.column_stack([t, lon, lat, p, nz])

    def text(name, head, separator, number, rows=columns, tail="\n", encoding="utf-8"):
        lines = [separator.join(number(value) for value in row) + tail for row in rows]
        with open(place(name), "w", encoding=encoding, newline="") as file:
            file.write(head + "".join(lines))

    plain, comma = lambda value: f"{value:g}", lambda value: f"{value:g}".replace(".", ",")
    text("units.csv", "time (s),LON (%),LAT (%),P [rad/s],NZ [g]\n", ",", plain)
    text("comma.csv", '# Höhe 2000 ft\n"t";"longitudinal [%]";"lateral [%]";"roll rate [rad/s]";"az [g]"\r\n', ";", comma, tail="\r\n", encoding="latin-1")
    text("plain.txt", "", " ", plain)
    strokes = "    _time,__sec |   _elev,yoke1 |   ailrn,yoke1 |   ____P,rad/s |   Gload,norml | \n"
    text("strokes.txt", strokes, " | ", lambda value: f"{value:13.5f}", tail=" | \n")
    runs = np.vstack([np.column_stack([np.full(60, run), columns]) for run in (4, 5)])
    text("runs.csv", "run,t_ms,LON,LAT,P,NZ\n", ",", plain, rows=runs * [1, 1000, 1, 1, 1, 1])
    again = np.vstack([columns, columns])
    text("restart.csv", "t,LON,LAT,P,NZ\n", "\t", plain, rows=again)

    sides = dict(t=t[:, None], inr=columns[:, 1:3], outr=columns[:, 3:], iwo=np.zeros((60, 7)))
    savemat(place("sides.mat"), sides, do_compression=True)
    labelled = dict(Ts=0.02, u=columns[:, 1:3].T, y=columns[:, 3:].T, InputName=np.array(["LON", "LAT"], object),
                    OutputName=np.array(["P", "NZ"], object), OutputUnit=np.array(["rad/s", "g"], object))
    savemat(place("struct.mat"), dict(rec=labelled, note="a sweep"), do_compression=True)
    savemat(place("old.mat"), dict(time=t, LON=lon, LAT=lat, P=p, NZ=nz), format="4")
    experiments = np.empty((1, 2), object)
    experiments[0, 0], experiments[0, 1] = columns[:, 3:], columns[:40, 3:]
    inputs = np.empty((1, 2), object)
    inputs[0, 0], inputs[0, 1] = columns[:, 1:3], columns[:40, 1:3]
    data = dict(OutputData=experiments, InputData=inputs, Ts=0.02, InputName=np.array(["LON", "LAT"], object),
                OutputName=np.array(["P", "NZ"], object), ExperimentName=np.array(["up", "down"], object))
    savemat(place("experiments.mat"), dict(data=data), do_compression=True)

    np.save(place("matrix.npy"), columns)
    np.savez_compressed(place("arrays.npz"), t=t, LON=lon, LAT=lat, P=p, NZ=nz)
    table = {name: [None if name == "P" and i == 7 else value for i, value in enumerate(column.tolist())]
             for name, column in zip(["t", "LON", "LAT", "P", "NZ"], columns.T)}
    with open(place("columns.json"), "w") as file:
        json.dump(table, file)
    with h5py.File(place("matlab73.mat"), "w", userblock_size=512) as file:
        for name, value in dict(t=t, LON=lon, LAT=lat, P=p, NZ=nz).items():
            dataset = file.create_dataset(name, data=value[None, :])
            dataset.attrs["MATLAB_class"] = np.bytes_("double")
    with zipfile.ZipFile(place("two.zip"), "w", zipfile.ZIP_DEFLATED) as archive:
        for name in ["units.csv", "sides.mat"]:
            archive.write(place(name), "records/" + name)
        archive.writestr("readme.md", "two records")


if __name__ == "__main__":
    os.makedirs(NPY, exist_ok=True)
    os.makedirs(MAT, exist_ok=True)
    npy_files()
    npz_files()
    check_written()
    matlab_numbers()
    matlab_nested()
    matlab_objects()
    matlab_hostile()
    plain_files()
    record_files()
