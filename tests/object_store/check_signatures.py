"""check_signatures.py REQUESTS.json: compares the signatures of requests with those that botocore makes of them."""

import datetime
import json
import sys
from unittest import mock

import botocore.auth
from botocore.awsrequest import AWSRequest
from botocore.credentials import Credentials

# What the library adds itself.
OWN = {"host", "x-amz-date", "x-amz-content-sha256", "x-amz-security-token"}


def signed_headers(authorization):
    return authorization.split("SignedHeaders=")[1].split(",")[0].split(";")


def expected(request, document):
    headers = request["headers"]
    moment = datetime.datetime.strptime(headers["x-amz-date"], "%Y%m%dT%H%M%SZ")
    others = {name: headers[name] for name in signed_headers(headers["authorization"]) if name not in OWN}
    signed = AWSRequest(method="GET", url=request["url"], headers=others)
    credentials = Credentials(document["key"], document["secret"], document["session"] or None)
    with mock.patch("botocore.auth.datetime") as clock:
        clock.datetime.utcnow.return_value = moment
        botocore.auth.S3SigV4Auth(credentials, "s3", document["region"]).add_auth(signed)
    return signed.headers["Authorization"]


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        document = json.load(file)
    wrong = 0
    for request in document["requests"]:
        theirs = expected(request, document)
        ours = request["headers"]["authorization"]
        if theirs != ours:
            print(f"{request['url']}\n  {request['headers']}\n  sent:     {ours}\n  botocore: {theirs}")
            wrong += 1
    return 1 if wrong or not document["requests"] else 0


sys.exit(main())
