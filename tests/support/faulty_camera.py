"""Cameras that speak just enough RTSP and ISAPI (HTTP) to refuse, redirect, or repeat what they were sent."""
import socket
import threading

REALM = "IP Camera"
USER_CHECK = ('<?xml version="1.0"?><userCheck><statusValue>401</statusValue><statusString>Unauthorized</statusString>'
              "<isActivated>true</isActivated>{}</userCheck>")
LOCKED = "<lockStatus>lock</lockStatus><unlockTime>600</unlockTime>"
UNLOCKED = "<lockStatus>unlock</lockStatus><retryLoginTime>4</retryLoginTime>"


class FaultyCamera:
    """A camera at `address`, ports 80 and 554, as a context. Its fault:

    digest, basic    refuses each password, after a challenge of this kind
    locked           refuses, and says that it is locked
    redirect         after a login sends the client elsewhere, with the login in the path
    repeat           after a login answers with an error that repeats the request
    silent, garbage  answers nothing, or nonsense
    """

    def __init__(self, fault, address):
        self.fault = fault
        self.servers = [socket.create_server((address, port), backlog=64) for port in (80, 554)]

    def __enter__(self):
        for server in self.servers:
            threading.Thread(target=self.accept, args=(server,), daemon=True).start()
        return self

    def __exit__(self, *_):
        for server in self.servers:
            server.shutdown(socket.SHUT_RDWR)
            server.close()

    def accept(self, server):
        while True:
            try:
                client, _ = server.accept()
            except OSError:
                return
            threading.Thread(target=self.serve, args=(client,), daemon=True).start()

    def serve(self, client):
        data = b""
        try:
            with client:
                client.settimeout(10)
                while chunk := client.recv(65536):
                    data += chunk
                    while b"\r\n\r\n" in data:
                        head, data = data.split(b"\r\n\r\n", 1)
                        if answer := self.answer(head.decode(errors="replace")):
                            client.sendall(answer)
                    if self.fault == "garbage":
                        return
        except OSError:
            pass

    def answer(self, request):
        if self.fault == "silent":
            return b""
        if self.fault == "garbage":
            return b"\x00\xff" * 500 + request.encode() + b"\r\n\r\n"
        login = next((line for line in request.splitlines() if line.lower().startswith("authorization:")), None)
        if login and self.fault == "redirect":
            return self.message(request, "302 Moved", f"Location: rtsp://192.0.2.1/{login.split()[-1]}\r\n")
        if login and self.fault == "repeat":
            return self.message(request, f"451 {login}", f"X-Error: {login}\r\n", request)
        scheme = "Basic" if self.fault in ("basic", "redirect", "repeat") else "Digest"
        nonce = ', nonce="1234567890abcdef", qop="auth"' if scheme == "Digest" else ""
        state = LOCKED if self.fault == "locked" else UNLOCKED
        return self.message(request, "401 Unauthorized", f'WWW-Authenticate: {scheme} realm="{REALM}"{nonce}\r\n',
                            USER_CHECK.format(state))

    @staticmethod
    def message(request, status, headers, body=""):
        protocol = request.splitlines()[0].split()[-1]
        sequence = next((line for line in request.splitlines() if line.lower().startswith("cseq:")), "CSeq: 1")
        return (f"{protocol} {status}\r\n{sequence}\r\n{headers}Content-Length: {len(body.encode())}\r\n"
                f"Content-Type: application/xml\r\n\r\n{body}").encode()
