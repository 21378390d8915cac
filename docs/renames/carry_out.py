#!/usr/bin/env python3
"""carry_out.py RUST_ANALYZER ROOT names.tsv [FROM [TO]]: carries out `file:line<TAB>Old<TAB>New` by rust-analyzer, one after another."""
import json, os, subprocess, sys, threading, queue, time, pathlib, re
RA, ROOT, LIST = sys.argv[1], os.path.realpath(sys.argv[2]), sys.argv[3]
first = int(sys.argv[4]) if len(sys.argv) > 4 else 0
last = int(sys.argv[5]) if len(sys.argv) > 5 else 10**9
env = dict(os.environ, CARGO_TARGET_DIR=os.environ.get("CARGO_TARGET_DIR", "/tmp/rename-target"))
p = subprocess.Popen([RA], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, cwd=ROOT, env=env)
inbox = {}
cond = threading.Condition()
quiet = threading.Event()
def send(m):
    b = json.dumps(dict(m, jsonrpc="2.0")).encode()
    p.stdin.write(b"Content-Length: %d\r\n\r\n" % len(b) + b); p.stdin.flush()
def reader():
    while True:
        n = None
        while True:
            l = p.stdout.readline()
            if not l: return
            l = l.strip()
            if not l: break
            if l.lower().startswith(b"content-length:"): n = int(l.split(b":")[1])
        m = json.loads(p.stdout.read(n))
        if "method" in m:
            if m["method"] == "experimental/serverStatus":
                print("status", m["params"], flush=True)
                if m["params"].get("quiescent"): quiet.set()
                else: quiet.clear()
            if "id" in m:
                r = None
                if m["method"] == "workspace/configuration": r = [CONF for _ in m["params"]["items"]]
                send({"id": m["id"], "result": r})
        else:
            with cond: inbox[m["id"]] = m; cond.notify_all()
CONF = {"checkOnSave": False, "cargo": {"buildScripts": {"enable": True}, "features": [], "extraArgs": ["--offline"]}, "procMacro": {"enable": True}, "cachePriming": {"enable": False}, "files": {"watcher": "client"}, "numThreads": 2}
ids = 0
def ask(method, params, wait=600):
    global ids
    ids += 1
    i = ids
    send({"id": i, "method": method, "params": params})
    end = time.time() + wait
    with cond:
        while i not in inbox:
            if not cond.wait(max(0.1, end - time.time())) and time.time() > end: raise TimeoutError(method)
        return inbox.pop(i)
threading.Thread(target=reader, daemon=True).start()
uri = lambda f: pathlib.Path(f).as_uri()
ask("initialize", {"processId": os.getpid(), "rootUri": uri(ROOT), "workspaceFolders": [{"uri": uri(ROOT), "name": "w"}], "initializationOptions": CONF,
    "capabilities": {"experimental": {"serverStatusNotification": True}, "workspace": {"configuration": True, "workspaceEdit": {"documentChanges": True}, "didChangeWatchedFiles": {"dynamicRegistration": False}},
                     "textDocument": {"rename": {"prepareSupport": True}}, "general": {"positionEncodings": ["utf-8"]}}})
send({"method": "initialized", "params": {}})
print("waiting for the workspace", flush=True)
quiet.wait(1800); time.sleep(2)
rows = [l.rstrip("\n").split("\t") for l in open(LIST) if l.strip() and not l.startswith("#")]
done = failed = 0
for k, row in enumerate(rows):
    if not first <= k < last: continue
    place, old, new = row[:3]
    file, line = place.rsplit(":", 1); line = int(line) - 1
    path = os.path.join(ROOT, file)
    text = open(path, encoding="utf-8").read().split("\n")
    m = line < len(text) and re.search(r"\b(?:struct|enum|trait|type|union)\s+(" + old + r")\b", text[line])
    if not m:
        print("NOT THERE", row, flush=True); failed += 1; continue
    col = len(text[line][:m.start(1)].encode())
    for attempt in range(3):
        a = ask("textDocument/rename", {"textDocument": {"uri": uri(path)}, "position": {"line": line, "character": col}, "newName": new})
        if "error" in a and a["error"].get("code") in (-32801, -32802): time.sleep(0.5); continue
        break
    if "error" in a or not a.get("result"):
        print("FAILED", row, a.get("error"), flush=True); failed += 1; continue
    changes = {}
    for c in a["result"].get("documentChanges", []):
        if "textDocument" in c: changes.setdefault(c["textDocument"]["uri"], []).extend(c["edits"])
    for u, e in (a["result"].get("changes") or {}).items(): changes.setdefault(u, []).extend(e)
    count = 0
    for u, edits in changes.items():
        f = u[len("file://"):]
        raw = open(f, "rb").read().split(b"\n")
        for e in sorted(edits, key=lambda e: (e["range"]["start"]["line"], e["range"]["start"]["character"]), reverse=True):
            s, t = e["range"]["start"], e["range"]["end"]
            assert s["line"] == t["line"], e
            l = raw[s["line"]]
            raw[s["line"]] = l[:s["character"]] + e["newText"].encode() + l[t["character"]:]
            count += 1
        open(f, "wb").write(b"\n".join(raw))
    send({"method": "workspace/didChangeWatchedFiles", "params": {"changes": [{"uri": u, "type": 2} for u in changes]}})
    done += 1
    print(k, old, "->", new, count, "places in", len(changes), "files", flush=True)
print("done", done, "failed", failed)
ask("shutdown", None); send({"method": "exit"})
